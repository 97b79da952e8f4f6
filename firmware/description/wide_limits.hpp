// Settings that leave a guard of the control loop without effect.
#pragma once

#include "firmware/description/rig_description.hpp"

namespace firmware {

/// Why a description must not move devices: a setting so wide that its guard hardly acts, or one that switches it off.
/// Each guard has a widest setting (the .cpp lists them with their reasons); beyond it [waivers] wide_limits says why.
[[nodiscard]] MotionObjection wide_objection(const RigDescription& description);

}  // namespace firmware
