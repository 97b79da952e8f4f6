#include "firmware/loop/duct_control/rollout.hpp"

#include "firmware/loop/kalman/square_matrices.hpp"
#include "model/components/fdva.hpp"

namespace firmware {
namespace {

using model::Channel;
using model::CoreIndex;

int open_ducts(hal::Openings open) { return model::count(static_cast<model::OpenDucts>(open.bits())); }

/// (2); the scales make the weights comparable: about the rms of a class B road at 100 km/h.
EstimatorMatrix cost_matrix(const EstimatorEquations& equations, const DuctPolicySettings& settings) {
  EstimatorMatrix c = EstimatorMatrix::Zero();
  const auto add = [&c](double weight, const EstimatorVector& row, double scale) {
    const double factor = weight / (scale * scale);
    for (int j = 0; j < estimator_states; ++j) {
      for (int i = 0; i < estimator_states; ++i) c(i, j) += factor * row(i) * row(j);
    }
  };
  add(settings.wheel_load, equations.row(Channel::F_w, 1, false), 500.0);
  const EstimatorVector body = equations.row(Channel::zdd_b, 1, false);
  add(settings.body_acceleration, body, 1.0);
  EstimatorVector component = body;
  const double damper = equations.rig().suspension.damping / equations.rig().body.mass;
  component(equations.core(CoreIndex::wheel_velocity)) -= damper;
  component(equations.core(CoreIndex::body_velocity)) += damper;
  add(settings.component_force, component, 1.0);
  add(settings.stroke, equations.row(Channel::dz_b, 1, false), 7e-3);
  return c;
}

}  // namespace

Rollout::Rollout(const EstimatorEquations& equations, SteadyGains& gains, const DuctPolicySettings& settings,
                 double period)
    : states_(equations.states()),
      ducts_(equations.ducts()),
      piston_(equations.core(CoreIndex::piston_velocity)),
      highest_peak_(settings.pressure_peak) {
  const auto& fdva = equations.rig().fdva;
  const double area = 0.25 * 3.141592653589793 * fdva.duct_diameter * fdva.duct_diameter;
  const double slow = 2.0 * fdva.duct_length / settings.closing_time;
  peak_per_velocity_ = fdva.oil_density * (slow < sound ? slow : sound) * fdva.piston_area / area;
  const EstimatorMatrix c = cost_matrix(equations, settings);
  const int horizon = nearest_periods(settings.horizon, period);
  EstimatorMatrix half, transposed, step;
  for (int open = 0; open <= ducts_; ++open) {
    PerCount& m = by_count_[static_cast<std::size_t>(open)];
    gains.compute(open);
    EstimatorMatrix a = equations.matrix(open);
    a(piston_, piston_) -= equations.linear_loss(gains.piston_rms(), open);
    m.transition = model::ExactDiscretisation<double, estimator_states>(a, period).transition();
    transposed = m.transition.transpose();
    m.cost.setZero();
    for (int k = 0; k < horizon; ++k) {  // M ← Φᵀ (C + M) Φ
      step = m.cost + c;
      multiply(half, step, m.transition, states_);
      multiply(m.cost, transposed, half, states_);
    }
  }
}

void Rollout::switch_ducts(EstimatorVector& x, hal::Openings before, hal::Openings open) const {
  if (open == before) return;
  const int were = open_ducts(before), stay = open_ducts(hal::Openings::from_bits(open.bits() & before.bits()));
  x(piston_) = were > 0 ? x(piston_) * stay / were : 0.0;
}

void Rollout::advance(EstimatorVector& x, hal::Openings before, hal::Openings open) const {
  switch_ducts(x, before, open);
  const EstimatorMatrix& transition = by_count_[static_cast<std::size_t>(open_ducts(open))].transition;
  EstimatorVector next = EstimatorVector::Zero();
  for (int j = 0; j < states_; ++j) {
    const double factor = x(j);
    for (int i = 0; i < states_; ++i) next(i) += transition(i, j) * factor;
  }
  x = next;
}

double Rollout::cost(const EstimatorVector& x, int open) const {
  const EstimatorMatrix& m = by_count_[static_cast<std::size_t>(open)].cost;
  double sum = 0.0;
  for (int j = 0; j < states_; ++j) {
    double column = 0.5 * m(j, j) * x(j);  // M is symmetric: the half above the diagonal counts twice
    for (int i = 0; i < j; ++i) column += m(i, j) * x(i);
    sum += column * x(j);
  }
  return 2.0 * sum;
}

double Rollout::pressure_peak(double piston_velocity, int open) const {
  if (open == 0) return 0.0;
  const double speed = piston_velocity < 0.0 ? -piston_velocity : piston_velocity;
  return peak_per_velocity_ * speed / open;
}

int Rollout::best(const EstimatorVector& x, hal::Openings open) const {
  const int now = open_ducts(open);
  const bool may_close = pressure_peak(x(piston_), now) <= highest_peak_;
  int chosen = now;
  double least = cost(x, now);
  for (int n = 0; n <= ducts_; ++n) {
    EstimatorVector begin = x;
    switch_ducts(begin, open, hal::Openings::first(static_cast<std::size_t>(n)));
    const double there = cost(begin, n);
    if (!(there < least) || (n < now && !may_close)) continue;
    least = there;
    chosen = n;
  }
  return chosen;
}

}  // namespace firmware
