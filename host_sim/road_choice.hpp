// What a user says about the road of a run, on whatever command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host_sim/profile_file.hpp"
#include "host_sim/rig_description.hpp"
#include "host_sim/road.hpp"

namespace host_sim {

/// --road and what goes with it.
struct RoadChoice {
  std::string road = "iso8608:B";   ///< iso8608:A … H, or a file with t [s] or s [m] and z_r [m]
  double speed = 27.78;             ///< [m/s]
  std::uint64_t seed = 1;           ///< of an ISO 8608 road
  std::optional<double> bandwidth;  ///< of an ISO 8608 road [Hz]
  std::optional<double> cut_off;    ///< of an ISO 8608 road [Hz]
};

/// The motion over it, `samples` samples or as many as the file has, at the rig's rate. UsageError for what does not
/// fit together, InputError for what is wrong with the file.
[[nodiscard]] FootPointMotion motion_over(const RoadChoice& choice, const RigDescription& rig, std::size_t samples,
                                          RecordingReader read);

/// The samples that a run of `duration` [s] has: 1 to 10 million, since a run is kept in memory; else UsageError.
[[nodiscard]] std::size_t samples_of(double duration, double sample_rate);

}  // namespace host_sim
