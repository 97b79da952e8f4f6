#include "firmware/loop/compensation/specimen_predictor.hpp"

namespace firmware::compensation {

SpecimenPredictor::SpecimenPredictor(const Settings& settings, double period)
    : component_(settings.component),
      period_(period),
      delay_(settings.machine.delay / period),
      machine_(
          [&] {
            model::MachinePath<double> path = settings.machine;
            path.delay = path.rate_limit = 0.0;
            return path;
          }(),
          period) {
  if (!component_.has_fdva) return;
  const auto& fdva = component_.fdva;
  const auto duct = model::Fdva<double>::duct(fdva);
  for (int open = 0; open <= static_cast<int>(model::duct_capacity); ++open) {
    const auto accelerates = [&](double velocity, double force) {
      return model::Fdva<double>::piston_acceleration(fdva, duct, open, velocity, force);
    };
    model::Block<double, 2, 2> a;  // (3)
    a << 0.0, open > 0 ? 1.0 : 0.0, accelerates(0.0, -fdva.coupling_stiffness), accelerates(1.0, 0.0);
    model::Column<double, 2> b;
    b << 0.0, accelerates(0.0, fdva.coupling_stiffness);
    const model::ExactDiscretisation<double, 2> exact(a, period);
    auto& step = steps_[static_cast<std::size_t>(open)];
    step.state = exact.transition();
    step.stroke = exact.hermite(b, model::Column<double, 2>::Zero());
  }
}

void SpecimenPredictor::start(State& x, const Stroke& at) const {
  x.line.start(at, delay_);  // in place: a whole state on the stack takes 4 KiB of it
  x.machine = machine_.start(at);
  x.delayed = x.reached = at;
  x.difference = {};
  x.piston.setZero();
}

void SpecimenPredictor::step(State& x, const Stroke& wanted, int open_ducts) const {
  x.line.push(wanted);
  const Stroke delayed = x.line.read(period_);
  const Stroke reached = machine_.step(x.machine, x.delayed, delayed, x.reached);
  x.delayed = delayed;
  x.reached = reached;
  const Stroke before = x.difference;
  x.difference = {wanted.position - reached.position, wanted.velocity - reached.velocity};
  if (!component_.has_fdva) return;
  const Step& step = steps_[static_cast<std::size_t>(open_ducts)];
  const auto inputs = model::driven_by(before, x.difference);
  model::Column<double, 2> next = step.stroke.col(0) * inputs[0];
  for (int j = 1; j < 4; ++j) next += step.stroke.col(j) * inputs[static_cast<std::size_t>(j)];
  for (int j = 0; j < 2; ++j) next += step.state.col(j) * x.piston(j);
  x.piston = next;
}

double SpecimenPredictor::force(const State& x) const {
  const double spring = component_.stiffness * x.difference.position + component_.damping * x.difference.velocity;
  if (!component_.has_fdva) return spring;
  return spring + component_.fdva.coupling_stiffness * (x.difference.position - x.piston(0));  // (2)
}

std::size_t SpecimenPredictor::reach() const { return static_cast<std::size_t>(delay_ + 1e-9) + 2; }

}  // namespace firmware::compensation
