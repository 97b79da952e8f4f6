#include "firmware/loop/guards/force_guard.hpp"

#include <cmath>

#include "model/effects/catalogue.hpp"
#include "model/rig/rig_equations.hpp"

namespace firmware {
namespace {

double plausible_stiffness(const model::RigParameters<double>& rig) {
  if (rig.kind == model::RigKind::quarter_car) return 0.0;
  model::SuspensionComponent<double> component{};
  rig.effects.act_on(component);
  const model::SensorPath<double> sensor = rig.effects.sensor_paths()[model::index(model::Channel::F)];
  if (component.free_play > 0.0 || sensor.limit > 0.0) return 0.0;
  const double spring = model::spring_stiffness(rig, true), mount = component.mount_stiffness;
  const double gain = sensor.gain < 0.0 ? -sensor.gain : sensor.gain;
  return gain * (mount > 0.0 ? spring * mount / (spring + mount) : spring);
}

}  // namespace

ForceGuard::ForceGuard(const Supervision& supervision, const model::RigParameters<double>& rig, double period)
    : least_(supervision.force_share * plausible_stiffness(rig)),
      stiffness_(plausible_stiffness(rig)),
      way_(supervision.force_way * supervision.force_way),
      mean_share_(period < 2.0 * memory ? period / (2.0 * memory) : 1.0),
      share_(period < memory ? period / memory : 1.0) {}

void ForceGuard::start() { started_ = false; }

std::optional<Trip> ForceGuard::follow(const SampleGuard& samples, hal::Time now) {
  using model::Channel;
  if (least_ <= 0.0 || !samples.good(Channel::F) || !samples.good(Channel::x_act)) return std::nullopt;
  const double x = samples.value(Channel::x_act), f = samples.value(Channel::F);
  if (!started_) {
    started_ = true;
    position_ = x;
    force_ = f;
    positions_ = forces_ = 0.0;
  }
  position_ += mean_share_ * (x - position_);  // (1)
  force_ += mean_share_ * (f - force_);
  const double dx = x - position_, df = f - force_;
  positions_ += share_ * (dx * dx - positions_);  // (2)
  forces_ += share_ * (df * df - forces_);
  const double least = least_ * least_ * positions_;
  if (positions_ <= way_ || forces_ >= least) return std::nullopt;  // (3)
  return Trip{Reason::innovation, Channel::F, std::sqrt(forces_), std::sqrt(least), now};
}

double ForceGuard::share() const {
  return positions_ > 0.0 && stiffness_ > 0.0 ? std::sqrt(forces_ / positions_) / stiffness_ : 0.0;
}

}  // namespace firmware
