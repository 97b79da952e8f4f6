// A recording in place of the rig's devices.
#pragma once

#include <memory>

#include "firmware/controller/devices/devices.hpp"

namespace firmware::controller {

/// What the recording's sensors said, row by row, at the times at which they said it; nobody sleeps. What the program
/// writes goes nowhere. InputError for a recording that does not fit the rig.
///
/// Each measured channel that the recording has is fitted; a sample that did not come (nan) is missing again, a late
/// period late again. Stamps are those of the rows: a recording keeps no others.
[[nodiscard]] std::unique_ptr<Devices> replay_devices(const RigDescription& rig, const Options& options);

}  // namespace firmware::controller
