// Roads from files.
#pragma once

#include <filesystem>

#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/road.hpp"

namespace firmware {

/// Reader of the file: read_csv_recording(), or one that also reads MATLAB files.
using RecordingReader = Recording (*)(const std::filesystem::path&, const ChannelMap&, std::optional<double>);

/// The motion over a road given as CSV (or .mat): z_r [m] over t [s], or (CSV only) over the distance s [m], converted
/// to time by `speed` [m/s]. The points are equally spaced. If their spacing h differs from the sample period, a cubic
/// Hermite polynomial interpolates (error of z_r at most h⁴/384 max|z_r⁗|, plus the velocity error of
/// through_samples()). The motion ends with the file or after `samples` samples.
///
/// InputError for another kind of file and for fewer than five points.
[[nodiscard]] FootPointMotion road_from_file(const std::filesystem::path& file, double speed, double sample_rate,
                                             std::size_t samples, RecordingReader read);

/// The same of a file that may hold the command of a rig of this kind in place of a road: z_cmd of a quarter_car, x_cmd
/// of a component_bench, F of a driven_mass, where it has no z_r.
struct RoadOrCommand {
  FootPointMotion motion;
  bool command = false;
};
[[nodiscard]] RoadOrCommand road_or_command(const std::filesystem::path& file, model::RigKind kind, double speed,
                                            double sample_rate, std::size_t samples, RecordingReader read);

}  // namespace firmware
