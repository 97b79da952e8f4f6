// Roads from files.
#pragma once

#include <filesystem>

#include "host_sim/road.hpp"

namespace host_sim {

/// The motion over a road given as CSV (or .mat): z_r [m] over t [s], or over the way s [m], which `speed` [m/s] turns
/// into time. Equally spaced; where its spacing is not that of the samples, values in between are taken from the cubic
/// Hermite polynomial through the points. It ends with the file, or after `samples` samples.
///
/// InputError for what is no such file, for fewer than five points, and for a spacing so coarse that the cylinder's
/// 40 Hz are above half its rate while the file is shorter than one sample.
[[nodiscard]] FootPointMotion road_from_file(const std::filesystem::path& file, double speed, double sample_rate,
                                             std::size_t samples);

}  // namespace host_sim
