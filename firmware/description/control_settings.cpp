#include "firmware/description/control_settings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "firmware/description/probe_response.hpp"
#include "firmware/description/text/input_error.hpp"

namespace firmware {

double highest_measured_force(const RigDescription& description) {
  double highest = std::numeric_limits<double>::infinity();
  for (const model::Channel channel : {model::Channel::F, model::Channel::F_w}) {
    const auto range = trusted_range(description, model::index(channel));
    if (range) highest = std::min({highest, std::abs(range->lower), std::abs(range->upper)});
  }
  return highest;
}

Settings control_settings(const RigDescription& description) {
  const ControllerDescription& c = description.controller;
  Settings settings = c.loop;
  settings.period = hal::seconds(description.period());
  if (std::abs(settings.period.seconds() * description.sample_rate - 1.0) > 1e-12) {
    throw InputError(description.source, 0, "the period of sample_rate is not a whole number of nanoseconds",
                     "a rate such as 1000.0, 500.0 or 2000.0 Hz");
  }
  settings.limits.stroke = c.stroke;
  settings.limits.speed = c.speed;
  settings.limits.force = c.force_given ? c.force : std::min(c.force, 0.95 * highest_measured_force(description));
  settings.limits.energy_gain = c.energy_gain;
  settings.limits.late_in_a_row = description.hardware.schedule.late_in_a_row;
  settings.ramps.rate = c.ramp;
  if (c.cross_over > 0.0) settings.observers.cross_over = c.cross_over;
  if (const auto wrong = settings.check(); !wrong.empty()) {
    throw InputError(description.source, 0, "the control settings are invalid", wrong);
  }
  return settings;
}

Arming arming_settings(const RigDescription& description) {
  Arming arming = description.controller.arming;
  if (arming.preload <= 0.0) arming.preload = 0.1 * control_settings(description).limits.force;
  if (arming.sway <= 0.0) arming.sway = 0.01 * control_settings(description).limits.force;
  if (arming.wander <= 0.0) arming.wander = 0.1 * arming.position_tolerance;
  if (description.rig.kind != model::RigKind::hil) arming.force_ramp = 0.0;
  if (const auto& gpio = description.hardware.gpio) {
    for (std::size_t i = 0; i < gpio->interlocks.size(); ++i) {
      if (gpio->interlocks[i].name == gpio->hold_to_run) arming.hold_to_run |= 1U << i;
    }
  }
  arming.allowed_gain = description.hardware.schedule.allowed_gain;
  if (arming.allowed_gain > 0.0) arming.probe_stiffness = probe_stiffness(description, arming.probe_amplitude);
  if (arming.probe_stiffness < 0.0) arming.probe_stiffness = 0.0;  // the sign is judged without it
  return arming;
}

ValvePlan valve_plan(const RigDescription& description) {
  const auto& fdva = description.rig.fdva;
  const auto first = hal::Openings::first(description.rig.has_fdva ? static_cast<std::size_t>(fdva.open_ducts) : 0);
  std::vector<ValvePlan::Change> changes;
  for (const auto& s : description.controller.valve_plan) {
    changes.push_back({hal::seconds(s.time), hal::Openings::from_bits(s.open)});
  }
  if (const auto wrong = ValvePlan::check(changes); !wrong.empty()) {
    throw InputError(description.source, 0, "valves.plan does not fit", wrong);
  }
  return {first, changes};
}

}  // namespace firmware
