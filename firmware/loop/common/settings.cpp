#include "firmware/loop/common/settings.hpp"

namespace firmware {
namespace {

/// Neither NaN (compares false) nor infinite (1e300 is far beyond any rig).
bool positive(double value) { return value > 0.0 && value < 1e300; }
bool not_negative(double value) { return value >= 0.0 && value < 1e300; }
/// Also never_reached.
bool positive_or_never(double value) { return value > 0.0; }

std::string_view check_motion(const Limits& limits, const Supervision& supervision) {
  if (!(limits.acceleration >= 0.0)) return "limits.acceleration: expected an acceleration above 0 m/s²";
  if (!positive_or_never(limits.following)) return "limits.following: expected a distance above 0 m";
  if (!not_negative(limits.following_least)) return "limits.following_least: expected a distance of at least 0 m";
  if (!positive(supervision.following_memory)) return "supervision.following_memory: expected a time above 0 s";
  if (!not_negative(supervision.following_share)) return "supervision.following_share: expected a share of at least 0";
  if (limits.measured_stroke != 0.0 && !(limits.measured_stroke >= limits.stroke)) {
    return "limits.measured_stroke: expected at least limits.stroke";
  }
  if (limits.measured_speed != 0.0 && !(limits.measured_speed >= limits.speed)) {
    return "limits.measured_speed: expected at least limits.speed";
  }
  if (!not_negative(supervision.following_time)) return "supervision.following_time: expected a time of at least 0 s";
  if (!positive(supervision.speed_window)) return "supervision.speed_window: expected a time above 0 s";
  if (!(supervision.frozen_time >= 0.0 && supervision.frozen_time <= 3600.0)) {
    return "supervision.frozen_time: expected 0 to 3600 s";
  }
  if (!positive_or_never(supervision.frozen_way)) return "supervision.frozen_way: expected a distance above 0 m";
  if (!positive_or_never(supervision.frozen_speed)) return "supervision.frozen_speed: expected a speed above 0 m/s";
  if (!positive_or_never(supervision.frozen_acceleration)) {
    return "supervision.frozen_acceleration: expected an acceleration above 0 m/s²";
  }
  if (!(supervision.late_leak > 0.0 && supervision.late_leak <= 1.0)) {
    return "supervision.late_leak: expected a number of periods, above 0 and at most 1";
  }
  if (!positive_or_never(supervision.gap)) return "supervision.gap: expected a time above 0 s";
  if (!positive_or_never(supervision.enable_time)) return "supervision.enable_time: expected a time above 0 s";
  if (!positive_or_never(supervision.unpowered_way)) return "supervision.unpowered_way: expected a distance above 0 m";
  if (!(supervision.force_share >= 0.0 && supervision.force_share <= 0.5)) {
    return "supervision.force_share: expected a share of 0 to 0.5";
  }
  if (!positive_or_never(supervision.force_way)) return "supervision.force_way: expected a distance above 0 m";
  if (!positive(supervision.innovation_noise) || !positive(supervision.innovation_share)) {
    return "supervision.innovation_noise, innovation_share: expected numbers above 0";
  }
  if (!positive_or_never(supervision.growth_time)) return "supervision.growth_time: expected a time above 0 s";
  return {};
}

}  // namespace

std::string_view Settings::check() const {
  if (period < hal::microseconds(10) || period > hal::milliseconds(1000)) return "period: expected 10 µs to 1 s";
  if (!positive(limits.stroke)) return "limits.stroke: expected a length above 0 m";
  if (!positive(limits.speed)) return "limits.speed: expected a speed above 0 m/s";
  if (!not_negative(limits.speed_time)) return "limits.speed_time: expected a time of at least 0 s";
  if (!positive(limits.force)) return "limits.force: expected a force above 0 N";
  if (!(limits.low_force >= 0.0 && limits.low_force <= limits.force)) {
    return "limits.low_force: expected a force of at most limits.force";
  }
  if (limits.bridged_in_a_row < 1) return "limits.bridged_in_a_row: expected at least 1 sample";
  if (!(limits.bridged_leak > 0.0 && limits.bridged_leak <= 1.0))
    return "limits.bridged_leak: expected above 0, at most 1";
  if (!(limits.stale_after >= 1.0 && limits.stale_after <= 1000.0)) {
    return "limits.stale_after: expected 1 to 1000 periods";
  }
  if (!(limits.late_after > 0.0 && limits.late_after <= 1.0)) {
    return "limits.late_after: expected a share of the period, above 0 and at most 1";
  }
  if (limits.late_in_a_row < 1) return "limits.late_in_a_row: expected at least 1 period";
  if (!positive(limits.energy_gain)) return "limits.energy_gain: expected a ratio above 0";
  if (!positive(limits.energy_memory)) return "limits.energy_memory: expected a time above 0 s";
  if (!not_negative(limits.energy_quiet)) return "limits.energy_quiet: expected a width of at least 0 m";
  if (limits.energy_cycles < 1) return "limits.energy_cycles: expected at least 1 cycle";
  if (const std::string_view wrong = check_motion(limits, supervision); !wrong.empty()) return wrong;
  const double half_stroke = 0.5 * limits.stroke;
  if (!(ramps.rest >= -half_stroke && ramps.rest <= half_stroke))
    return "ramps.rest: expected a place within the stroke";
  if (limits.low_speed != 0.0 && !(limits.low_speed >= 1.25 * ramps.rate && positive(limits.low_speed)))
    return "limits.low_speed: expected at least 1.25 times limits.ramp";
  if (!(ramps.rate > 0.0 && ramps.rate <= limits.speed)) return "ramps.rate: expected above 0, at most limits.speed";
  if (!positive(ramps.braking)) return "ramps.braking: expected a deceleration above 0 m/s²";
  if (!not_negative(ramps.settling)) return "ramps.settling: expected a time of at least 0 s";
  if (!not_negative(arming.tare_time) || arming.tare_time > 10.0) return "arming.tare_time: expected 0 to 10 s";
  if (arming.tare_time > 0.0 && !positive(arming.preload)) return "arming.preload: expected a force above 0 N";
  if (!not_negative(arming.sway)) return "arming.sway: expected a force of at least 0 N";
  if (!not_negative(arming.wander)) return "arming.wander: expected a distance of at least 0 m";
  if (!(arming.position_tolerance >= 0.0 && arming.position_tolerance <= half_stroke))
    return "arming.position_tolerance: expected 0 m to half the stroke";
  if (!(arming.probe_amplitude >= 0.0 && arming.probe_amplitude <= 0.25 * half_stroke))
    return "arming.probe_amplitude: expected 0 m to an eighth of the stroke";
  if (arming.probe_amplitude > 0.0 && !(arming.tare_time > 0.0 && arming.position_tolerance > 0.0))
    return "arming.probe_amplitude: expected a tare_time and a position_tolerance above 0 beside a probe";
  if (!not_negative(arming.stop_test)) return "arming.stop_test: expected a time of at least 0 s";
  if (!not_negative(arming.probe_stiffness)) return "arming.probe_stiffness: expected at least 0 N/m";
  if (arming.allowed_gain != 0.0 && !(arming.allowed_gain > 1.0 && positive(arming.allowed_gain)))
    return "arming.allowed_gain: expected a factor above 1";
  if (!not_negative(arming.force_ramp)) return "arming.force_ramp: expected a time of at least 0 s";
  if (!positive(observers.cross_over)) return "observers.cross_over: expected a frequency above 0 Hz";
  if (!positive(observers.differentiation)) return "observers.differentiation: expected a frequency above 0 Hz";
  return {};
}

}  // namespace firmware
