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
      way_(supervision.force_way * supervision.force_way),
      lag_share_(period / (lag + period)),
      block_(memory / period) {}

void ForceGuard::start() {
  started_ = false;
  sums_ = {};
}

std::optional<Trip> ForceGuard::follow(const SampleGuard& samples, hal::Time now) {
  using model::Channel;
  if (!samples.good(Channel::F) || !samples.good(Channel::x_act)) return std::nullopt;
  const double x = samples.value(Channel::x_act), f = samples.value(Channel::F);
  if (!started_) lagged_ = x;
  started_ = true;
  lagged_ += lag_share_ * (x - lagged_);  // (1)
  const double u = x - lagged_;
  Sums& s = sums_;
  s.n += 1.0;  // (2)
  s.x += x;
  s.u += u;
  s.f += f;
  s.xx += x * x;
  s.xu += x * u;
  s.xf += x * f;
  s.uu += u * u;
  s.uf += u * f;
  if (s.n < block_) return std::nullopt;
  const double mean_x = s.x / s.n, mean_u = s.u / s.n;
  const double motion = s.xx - mean_x * s.x, xu = s.xu - mean_x * s.u, by_x = xu / motion;
  const double of_x = s.xf - mean_x * s.f, of_u = s.uf - mean_u * s.f - by_x * of_x;
  const double rest = s.uu - mean_u * s.u - by_x * xu;
  const bool moves = motion > s.n * way_;
  const double answer = std::sqrt((of_x * of_x / motion + of_u * of_u / rest) / motion);  // (3)
  sums_ = {};
  if (!(moves && answer < least_)) return std::nullopt;  // (4)
  return hazard_of(Reason::innovation, Channel::F, answer, least_, now);
}

}  // namespace firmware
