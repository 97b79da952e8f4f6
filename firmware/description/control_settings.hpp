// Settings of the control loop from a rig description.
#pragma once

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/valve_plan.hpp"

namespace firmware {

/// The largest |F| and |F_w| that the sensors can show, by [range] and half a count of their converters [N]; infinite
/// where no range is known.
[[nodiscard]] double highest_measured_force(const RigDescription& description);

/// Period, limits, ramps and observers. InputError if the period is not a whole number of nanoseconds or if
/// Settings::check() fails.
[[nodiscard]] Settings control_settings(const RigDescription& description);

/// What is looked at before a rig of devices moves. A simulated or replayed rig goes without (Settings' own default):
/// it has nothing to be wrong about.
[[nodiscard]] Arming arming_settings(const RigDescription& description);

/// The ducts that are open at the start and every later change. InputError if ValvePlan::check() fails.
[[nodiscard]] ValvePlan valve_plan(const RigDescription& description);

}  // namespace firmware
