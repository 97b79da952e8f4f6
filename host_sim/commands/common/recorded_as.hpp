// A recording as sensors and recorder of a description have made it.
#pragma once

#include "firmware/description/rig_description.hpp"
#include "host_sim/comparison/comparison.hpp"

namespace host_sim {

/// How compare and show simulate a recording: driven by its input without the noise above its motion, and with what
/// stands under [recording].
[[nodiscard]] RecordedAs recorded_as(const firmware::RigDescription& description);

}  // namespace host_sim
