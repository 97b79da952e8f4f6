// The table [recording] of a rig description.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/values/recorder_description.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// InputError with its line for each value that does not fit. `hold` is read as an effect sensor_hold of each of its
/// channels.
[[nodiscard]] RecorderDescription read_recorder(DescriptionTable& top, model::RigParameters<double>& rig);

/// Keys and values that read back to the same numbers.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> recorder_lines(const RecorderDescription& recorder);

}  // namespace firmware
