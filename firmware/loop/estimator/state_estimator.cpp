#include "firmware/loop/estimator/state_estimator.hpp"

#include <limits>

namespace firmware {
namespace {

using model::Channel;
constexpr double not_estimated = std::numeric_limits<double>::quiet_NaN();

std::optional<double> difference(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b) return std::nullopt;
  return *a - *b;
}

}  // namespace

template <class Known>
StateEstimator::Places StateEstimator::places(const Known& known) {
  Places p;
  const std::optional<double> z_w = known(Channel::z_w);
  const std::optional<double> z_b = known(Channel::z_b);
  const std::optional<double> dz_w = known(Channel::dz_w);
  const std::optional<double> dz_b = known(Channel::dz_b);
  const std::optional<double> x_act = known(Channel::x_act);
  p.foot_point = {known(Channel::z_r), known(Channel::zdd_r)};
  p.wheel = {z_w ? z_w : difference(p.foot_point.displacement, dz_w), known(Channel::zdd_w)};
  p.body = {z_b ? z_b : difference(p.wheel.displacement, dz_b), known(Channel::zdd_b)};
  p.deflection = {x_act ? x_act : dz_b, std::nullopt};
  p.tyre_deflection = dz_w ? dz_w : difference(p.foot_point.displacement, z_w);
  return p;
}

StateEstimator::StateEstimator(const SampleGuard& samples, double tyre_stiffness, const Observers& settings,
                               double period)
    : tyre_stiffness_(tyre_stiffness),
      velocities_{not_estimated, not_estimated, not_estimated, not_estimated},
      wheel_load_(not_estimated),
      foot_point_(VelocityObserver::Inputs::nothing, settings, period),
      wheel_(foot_point_),
      body_(foot_point_),
      deflection_(foot_point_) {
  const Places fitted = places(
      [&samples](Channel channel) { return samples.fitted(channel) ? std::optional<double>(0.0) : std::nullopt; });
  foot_point_ = VelocityObserver(inputs(fitted.foot_point), settings, period);
  wheel_ = VelocityObserver(inputs(fitted.wheel), settings, period);
  body_ = VelocityObserver(inputs(fitted.body), settings, period);
  deflection_ = VelocityObserver(inputs(fitted.deflection), settings, period);
}

VelocityObserver::Inputs StateEstimator::inputs(const Place& place) {
  using Inputs = VelocityObserver::Inputs;
  if (place.displacement) return place.acceleration ? Inputs::both : Inputs::displacement;
  return place.acceleration ? Inputs::acceleration : Inputs::nothing;
}

double StateEstimator::follow(VelocityObserver& observer, const Place& place) {
  if (observer.inputs() == VelocityObserver::Inputs::nothing) return not_estimated;
  return observer.step(place.displacement.value_or(0.0), place.acceleration.value_or(0.0));
}

void StateEstimator::restart() {
  for (VelocityObserver* observer : {&foot_point_, &wheel_, &body_, &deflection_}) observer->restart();
}

void StateEstimator::step(const SampleGuard& samples) {
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (samples.fitted(model::channel_at(i)) && !samples.seen(model::channel_at(i))) return;
  }
  const Places now = places([&samples](Channel channel) {
    return samples.fitted(channel) ? std::optional<double>(samples.value(channel)) : std::nullopt;
  });
  velocities_.foot_point = follow(foot_point_, now.foot_point);
  velocities_.wheel = follow(wheel_, now.wheel);
  velocities_.body = follow(body_, now.body);
  const double differentiated = follow(deflection_, now.deflection);
  const bool both =
      wheel_.inputs() != VelocityObserver::Inputs::nothing && body_.inputs() != VelocityObserver::Inputs::nothing;
  velocities_.deflection = both ? velocities_.wheel - velocities_.body : differentiated;  // (3)
  wheel_load_ =
      now.tyre_deflection && tyre_stiffness_ > 0.0 ? tyre_stiffness_ * *now.tyre_deflection : not_estimated;  // (4)
}

}  // namespace firmware
