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
  change_ = nearest_periods(change_after, period);
  if (change_ > horizon) change_ = horizon;
  for (int open = 0; open <= ducts_; ++open) {
    gains.compute(open);
    EstimatorMatrix a = equations.matrix(open);
    a(piston_, piston_) -= equations.linear_loss(gains.piston_rms(), open);
    transition_[static_cast<std::size_t>(open)] =
        model::ExactDiscretisation<double, estimator_states>(a, period).transition();
  }
  compute_forms(c, horizon);
}

void Rollout::continue_cost(EstimatorMatrix& m, const EstimatorMatrix& c, int open, int periods) const {
  const EstimatorMatrix& transition = transition_[static_cast<std::size_t>(open)];
  const EstimatorMatrix transposed = transition.transpose();
  EstimatorMatrix half;
  for (int k = 0; k < periods; ++k) {
    m += c;
    multiply(half, m, transition, states_);
    multiply(m, transposed, half, states_);
  }
}

void Rollout::keep(Form& form, const EstimatorMatrix& m) const {
  std::size_t at = 0;
  for (int j = 0; j < states_; ++j) {
    for (int i = 0; i <= j; ++i) form[at++] = m(i, j);
  }
}

/// Beginning with the ends: M_m of the last H − K periods stands at M_mm until all others have used it.
void Rollout::compute_forms(const EstimatorMatrix& c, int horizon) {
  EstimatorMatrix m;
  const auto form = [this](int open, int later) -> Form& {
    return forms_[static_cast<std::size_t>(open)][static_cast<std::size_t>(later)];
  };
  for (int later = 0; later <= ducts_; ++later) {
    m.setZero();
    continue_cost(m, c, later, horizon - change_);
    keep(form(later, later), m);
  }
  for (const bool same : {false, true}) {
    for (int open = 0; open <= ducts_; ++open) {
      for (int later = 0; later <= ducts_; ++later) {
        if ((open == later) != same) continue;
        const double left = open == 0 ? 0.0 : static_cast<double>(open < later ? open : later) / open;
        m.setZero();
        std::size_t at = 0;
        for (int j = 0; j < states_; ++j) {
          for (int i = 0; i <= j; ++i) {
            m(i, j) = m(j, i) = form(later, later)[at++] * (i == piston_ ? left : 1.0) * (j == piston_ ? left : 1.0);
          }
        }
        continue_cost(m, c, open, change_);
        keep(form(open, later), m);
      }
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
  const EstimatorMatrix& transition = transition_[static_cast<std::size_t>(open_ducts(open))];
  EstimatorVector next = EstimatorVector::Zero();
  for (int j = 0; j < states_; ++j) {
    const double factor = x(j);
    for (int i = 0; i < states_; ++i) next(i) += transition(i, j) * factor;
  }
  x = next;
}

double Rollout::cost(const EstimatorVector& x, int open, int later) const {
  const Form& m = forms_[static_cast<std::size_t>(open)][static_cast<std::size_t>(later)];
  double sum = 0.0;
  std::size_t at = 0;
  for (int j = 0; j < states_; ++j) {
    double column = 0.0;
    for (int i = 0; i < j; ++i) column += m[at++] * x(i);
    sum += (column + 0.5 * m[at++] * x(j)) * x(j);  // M is symmetric: the half above the diagonal counts twice
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
  double least = cost(x, now, now);
  for (int n = 0; n <= ducts_; ++n) {
    EstimatorVector begin = x;
    switch_ducts(begin, open, hal::Openings::first(static_cast<std::size_t>(n)));
    for (int later = 0; later <= ducts_; ++later) {
      const double there = cost(begin, n, later);
      if (!(there < least) || (n < now && !may_close)) continue;
      least = there;
      chosen = n;
    }
  }
  return chosen;
}

}  // namespace firmware
