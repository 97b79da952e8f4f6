// Checks of a run before anything moves: is there a reason to refuse it?
#pragma once

#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/simulation/road.hpp"

namespace firmware {

/// Drives the whole run beforehand, in memory, and holds its commands against the limits of the control loop.
/// quarter_car and component_bench: the commands are the excitation itself. hil: the described rig is simulated with
/// its car, without noise, with the step that the loop runs.
///
/// Refused, each in one line with the time and what would do:
///   a command beyond the stroke, a position that is no number, an excitation that looks like millimetres;
///   a command that CommandGuard would trip at: limited for longer than speed_time;
///   a step: a speed above twice limits.speed, or an acceleration above twice limits.acceleration, the first period
///   from rest included. Less than that the loop slows down for a moment and counts it; hil: a force of the described
///   component beyond limits.force; a compensation that adds more than it may.
/// Empty: the run is allowed. A run takes about 1 µs a sample on a PC.
[[nodiscard]] MotionObjection run_objection(const RigDescription& description, const FootPointMotion& excitation);

/// Limits that can never trip, or do not fit each other or the devices of the description. Empty: none.
[[nodiscard]] MotionObjection limits_objection(const RigDescription& description);

/// Devices without a sensor of the position (x_act, z_r of a quarter_car): nothing would notice a drive that does not
/// follow. Empty: there is one, or [waivers] no_following_error.
[[nodiscard]] MotionObjection following_objection(const RigDescription& description);

}  // namespace firmware
