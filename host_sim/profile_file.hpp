// Roads from files.
#pragma once

#include <filesystem>

#include "host_sim/recording.hpp"
#include "host_sim/road.hpp"

namespace host_sim {

/// What reads the file: read_recording, or for a program without MATLAB files read_csv_recording.
using RecordingReader = Recording (*)(const std::filesystem::path&, const ChannelMap&, std::optional<double>);

/// The motion over a road given as CSV (or .mat): z_r [m] over t [s], or (CSV only) over the way s [m], which `speed`
/// [m/s] turns into time. Equally spaced; where its spacing h is not that of the samples, values in between are taken
/// from the cubic Hermite polynomial through the points (error of z_r at most h⁴/384 max|z_r⁗|, plus what
/// through_samples says of velocities). It ends with the file, or after `samples` samples.
///
/// InputError for what is no such file and for fewer than five points.
[[nodiscard]] FootPointMotion road_from_file(const std::filesystem::path& file, double speed, double sample_rate,
                                             std::size_t samples, RecordingReader read);
[[nodiscard]] inline FootPointMotion road_from_file(const std::filesystem::path& file, double speed, double sample_rate,
                                                    std::size_t samples) {
  return road_from_file(file, speed, sample_rate, samples, read_recording);
}

}  // namespace host_sim
