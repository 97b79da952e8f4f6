// Set-up of the simulated back-end of hal for a rig description.
#pragma once

#include "firmware/description/rig_description.hpp"
#include "hal/sensor_source.hpp"
#include "hal/simulated/rig.hpp"

namespace firmware {

/// Sensors of a simulated rig: those of the paper's rigs, with the described measuring ranges.
[[nodiscard]] hal::SensorSetup simulated_sensors(const RigDescription& description);

/// Period, sensors, ducts, safe position and interlocks of the simulated rig, whose drive has an enable; its time
/// begins at `start`.
[[nodiscard]] hal::simulated::Construction simulated_construction(const RigDescription& description,
                                                                  hal::Time start = {});

}  // namespace firmware
