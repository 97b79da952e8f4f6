// The tables [calibration.CHANNEL] of a rig description.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/values/calibration_description.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// InputError with its line for each value that does not fit: a channel that this kind of rig computes or commands
/// itself, an uncertainty below 0, a day that is in no calendar, a certificate that ends before it begins, the serial
/// number of a certificate without that of the sensor.
[[nodiscard]] Calibrations read_calibrations(DescriptionTable& top, const model::RigParameters<double>& rig);

/// Keys and values of one table that read back to the same.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> calibration_lines(
    const CalibrationDescription& calibration);

}  // namespace firmware
