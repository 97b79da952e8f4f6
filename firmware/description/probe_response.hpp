// The answer of the described component to the probe of an arming.
#pragma once

#include "firmware/description/rig_description.hpp"

namespace firmware {

/// Force over deflection [N/m] of a hil rig's machine and component in the probe of `amplitude` [m] about rest, with the
/// ducts as they are in safe: equation (2) of ArmingChecks on samples of the model. 0: no such rig, or no probe.
[[nodiscard]] double probe_stiffness(const RigDescription& description, double amplitude);

}  // namespace firmware
