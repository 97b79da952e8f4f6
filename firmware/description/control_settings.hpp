// Settings of the control loop from a rig description.
#pragma once

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/settings.hpp"
#include "firmware/loop/valve_plan.hpp"

namespace firmware {

/// Period, limits, ramps and observers. InputError if the period is not a whole number of nanoseconds or if
/// Settings::check() fails.
[[nodiscard]] Settings control_settings(const RigDescription& description);

/// What is looked at before a rig of devices moves. A simulated or replayed rig goes without (Settings' own default):
/// it has nothing to be wrong about.
[[nodiscard]] Arming arming_settings(const RigDescription& description);

/// The ducts that are open at the start and every later change. InputError if ValvePlan::check() fails.
[[nodiscard]] ValvePlan valve_plan(const RigDescription& description);

}  // namespace firmware
