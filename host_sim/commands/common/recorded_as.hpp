// A recording as sensors and recorder of a description have made it.
#pragma once

#include "firmware/description/rig_description.hpp"
#include "host_sim/comparison/comparison.hpp"

namespace host_sim {

/// Filters, clocks, hum and drifts of the recorder ([recording]), and the input without its sensor's noise, for a
/// simulation that is held against a recording.
[[nodiscard]] RecordedAs recorded_as(const firmware::RigDescription& description);

}  // namespace host_sim
