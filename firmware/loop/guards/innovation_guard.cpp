#include "firmware/loop/guards/innovation_guard.hpp"

#include <cmath>

#include "firmware/loop/kalman/innovation_monitor.hpp"

namespace firmware {
namespace {

/// (4)
double noise_limit(double samples, double tail) {
  const double variance = 2.0 / (9.0 * samples);
  const double root = 1.0 - variance + normal_quantile(tail < 0.5 ? tail : 0.5) * std::sqrt(variance);
  return root * root * root;
}

}  // namespace

InnovationGuard::InnovationGuard(const Supervision& supervision, const EstimatorEquations& equations, double period)
    : count_(equations.channels()),
      mean_share_(period < 2.0 * memory ? period / (2.0 * memory) : 1.0),
      share_(period < memory ? period / memory : 1.0),
      limit_(supervision.innovation_noise * supervision.innovation_noise *
             noise_limit(2.0 / share_, equations.settings().false_alarms * period / 3600.0 / equations.channels())),
      model_(supervision.innovation_share * supervision.innovation_share) {
  for (int i = 0; i < count_; ++i) names_[static_cast<std::size_t>(i)] = equations.channel(i);
}

std::optional<Trip> InnovationGuard::follow(const KalmanFilter& filter, hal::Time now) {
  std::optional<Trip> hazard;
  double worst = 0.0;
  for (int i = 0; i < count_; ++i) {
    const double innovation = filter.innovation(i), expected = filter.expected(i);
    if (innovation == 0.0) continue;  // none in this period
    PerChannel& c = channels_[static_cast<std::size_t>(i)];
    if (!c.started) c = {true, innovation, expected, 0.0, 0.0};
    c.mean += mean_share_ * (innovation - c.mean);  // (1)
    c.expected_mean += mean_share_ * (expected - c.expected_mean);
    const double d = innovation - c.mean, e = expected - c.expected_mean;
    c.squares += share_ * (d * d - c.squares);  // (2)
    c.expected_squares += share_ * (e * e - c.expected_squares);
    const double allowed = limit_ > model_ * c.expected_squares ? limit_ : model_ * c.expected_squares;
    if (c.squares <= allowed || c.squares <= worst * allowed) continue;  // (3)
    worst = c.squares / allowed;
    const double deviation = filter.deviation(i);
    hazard = Trip{Reason::innovation, names_[static_cast<std::size_t>(i)], deviation * std::sqrt(c.squares),
                  deviation * std::sqrt(allowed), now};
  }
  return hazard;
}

double InnovationGuard::share(int channel) const {
  const PerChannel& c = at(channel);
  return c.expected_squares > 0.0 ? std::sqrt(c.squares / c.expected_squares) : 0.0;
}

}  // namespace firmware
