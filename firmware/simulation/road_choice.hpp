// The road of a run as chosen on a command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/simulation/profile_file.hpp"
#include "firmware/simulation/road.hpp"

namespace firmware {

/// --road and its related options.
struct RoadChoice {
  std::string road =
      "iso8608:B";       ///< iso8608:A … H, or a file with t [s] or s [m] and z_r [m] (run_motion(): or the command)
  double speed = 27.78;  ///< [m/s]
  std::uint64_t seed = 1;           ///< of an ISO 8608 road
  std::optional<double> bandwidth;  ///< of an ISO 8608 road [Hz]
  std::optional<double> cut_off;    ///< of an ISO 8608 road [Hz]
};

/// The motion over the road at the rig's sample rate: `samples` samples, or the length of the file if shorter.
/// UsageError for options that exclude each other, InputError for errors in the file.
[[nodiscard]] FootPointMotion motion_over(const RoadChoice& choice, const RigDescription& rig, std::size_t samples,
                                          RecordingReader read);

/// What a run is commanded: excitation() of that motion; a file that holds the command itself (road_or_command()) as it
/// is.
[[nodiscard]] FootPointMotion run_motion(const RoadChoice& choice, const RigDescription& rig, std::size_t samples,
                                         RecordingReader read);

/// Number of samples of a run of `duration` [s]: 1 to 10 million, because a run is kept in memory; else UsageError.
[[nodiscard]] std::size_t samples_of(double duration, double sample_rate);

}  // namespace firmware
