// The rig's model in place of its devices.
#pragma once

#include <memory>

#include "firmware/controller/devices/devices.hpp"

namespace firmware::controller {

/// In the machine's time, or in virtual time.
[[nodiscard]] std::unique_ptr<Devices> simulate_devices(const RigDescription& rig, const Options& options);

}  // namespace firmware::controller
