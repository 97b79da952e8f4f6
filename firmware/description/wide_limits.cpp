#include "firmware/description/wide_limits.hpp"

#include <array>
#include <string>
#include <string_view>

#include "firmware/description/control_settings.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/values/loop_settings.hpp"

namespace firmware {
namespace {

/// Without words a setting stays within these.
struct Usual {
  std::string_view table, key;
  double lowest, highest;
};

// About four times the default, where nothing is said: a rig that needs more is another kind of rig, or a unit is
// wrong.
constexpr std::array usual_settings{
    Usual{"limits", "acceleration", 0.0, 500.0},  // 0: follows from the speed
    Usual{"limits", "following", 0.0, 0.025},     // a tenth of the usual stroke
    Usual{"limits", "following_least", 0.0, 0.005},
    Usual{"supervision", "bridged_in_a_row", 1.0, 10.0},
    Usual{"supervision", "bridged_leak", 0.05, 0.5},  // more: half of all samples may be bad for ever
    Usual{"supervision", "stale_after", 1.0, 20.0},
    Usual{"supervision", "late_after", 0.01, 0.5},
    Usual{"supervision", "late_leak", 0.05, 0.5},  // more: every second period may be late for ever
    Usual{"motion", "braking", 5.0, 100.0},        // 49 mm from the usual speed; a knock beyond the acceleration limit
    Usual{"supervision", "speed_time", 0.0, 0.2},
    Usual{"supervision", "following_time", 0.0, 0.2},
    Usual{"supervision", "following_memory", 0.0, 2.0},
    Usual{"supervision", "following_share", 0.0, 0.2},
    Usual{"supervision", "speed_window", 0.0, 0.04},
    Usual{"supervision", "frozen_time", 0.001, 0.8},  // 0: no channel is watched
    Usual{"supervision", "frozen_way", 0.0, 0.01},
    Usual{"supervision", "frozen_speed", 0.0, 0.2},
    Usual{"supervision", "frozen_acceleration", 0.0, 2.0},
    Usual{"supervision", "gap", 0.0, 0.04},  // 28 mm at the usual speed
    Usual{"supervision", "energy_memory", 0.0, 2.0},
    Usual{"supervision", "energy_quiet", 0.0, 0.01},
    Usual{"supervision", "energy_cycles", 1.0, 12.0},
    Usual{"supervision", "enable_time", 0.0, 0.5},  // ISO 13849: contactors need less than 0.1 s
    Usual{"supervision", "unpowered_way", 0.0, 0.01},
    Usual{"supervision", "force_share", 0.01, 0.5},  // 0: a force is never implausible
    Usual{"supervision", "force_way", 0.0, 0.01},
    Usual{"supervision", "innovation_noise", 1.0, 12.0},
    Usual{"supervision", "innovation_share", 0.05, 0.8},  // 1: a sensor that is torn off
    Usual{"supervision", "growth_time", 0.0, 0.4},
};

MotionObjection objection(std::string_view table, std::string_view key, double value, double lowest, double highest) {
  const std::string path = std::string(table) + "." + std::string(key);
  return {path + " = " + shortest(value) + " leaves its guard without effect: " + shortest(lowest) + " to " +
              shortest(highest) + ", or [waivers] wide_limits = \"why\"",
          path};
}

}  // namespace

MotionObjection wide_objection(const RigDescription& description) {
  if (description.waivers.contains("wide_limits")) return {};
  const ControllerDescription& controller = description.controller;
  for (const Usual& usual : usual_settings) {
    for (const LoopSetting& setting : loop_settings()) {
      if (setting.table != usual.table || setting.key != usual.key) continue;
      const double value = setting.get(controller.loop);
      // A limit that does not act by a waiver of its own is no number of the description.
      if (value == never_reached || (value >= usual.lowest && value <= usual.highest)) continue;
      return objection(usual.table, usual.key, value, usual.lowest, usual.highest);
    }
  }
  const Arming arming = arming_settings(description);
  const Settings settings = control_settings(description);
  const double force = settings.limits.force, low_force = settings.limits.highest_low_force();
  const double low_speed = settings.highest_low_speed();
  const bool hil = description.rig.kind == model::RigKind::hil;
  struct Value {
    std::string_view table, key;
    double value, lowest, highest;
  };
  for (const Value& v : {
           Value{"limits", "speed", controller.speed, 0.0, 2.0},  // faster than the cylinders of such rigs
           Value{"limits", "force", force, 0.0, 100e3},
           Value{"limits", "stroke", settings.limits.stroke, 0.0, 1.0},
           Value{"limits", "measured_stroke", settings.limits.highest_measured_stroke(), 0.0,
                 1.1 * settings.limits.stroke},
           Value{"limits", "measured_speed", settings.limits.highest_measured_speed(), 0.0,
                 2.0 * settings.limits.speed},
           Value{"limits", "ramp", controller.ramp, 0.0, 0.2},  // four fifths of the reduced speed below
           Value{"limits", "low_speed", low_speed, 0.0, 0.25},  // reduced speed of ISO 10218-1, beside people
           Value{"limits", "low_force", low_force, 0.0, 0.5 * force},
           Value{"limits", "energy_gain", controller.energy_gain, 0.0, 1.5},
           Value{"controller", "late_in_a_row", static_cast<double>(description.hardware.schedule.late_in_a_row), 1.0,
                 50.0},
           Value{"arming", "preload", arming.preload, 0.0, 0.25 * force},
           Value{"arming", "sway", arming.sway, 0.0, 0.05 * force},
           Value{"arming", "wander", arming.wander, 0.0, 0.005},
           Value{"arming", "stop_test", arming.stop_test / 3600.0, 0.0, 168.0},       // a week; ISO 14119: a month
           Value{"arming", "force_ramp", arming.force_ramp, hil ? 0.05 : 0.0, 10.0},  // 0: F enters a car at once
           Value{"arming", "position_tolerance", arming.position_tolerance, 0.0, 0.02},
       }) {
    if (v.value < v.lowest || v.value > v.highest) return objection(v.table, v.key, v.value, v.lowest, v.highest);
  }
  return {};
}

}  // namespace firmware
