// Step 1: recordings as a user brings them become recordings that can be compared with simulations.
#pragma once

#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace host_sim::identification {

struct Record {
  firmware::Recording recording;
  Use use;
};

/// Of a long recording, the seconds from its beginning on and the seconds up to its end that a diagnosis uses.
struct UsedSeconds {
  double first, last;
};
[[nodiscard]] UsedSeconds used_of_long(Use use);

/// "of 3600 s the first 120 s are fitted, the last 40 s held out".
[[nodiscard]] std::string shortened(double seconds, Use use);

struct PreparedData {
  std::vector<PreparedRecording> recordings;  ///< all with the same channels
  std::vector<std::string> remarks;           ///< what was left out or shortened
};

/// In this order:
///
///   1  of a long recording the beginning is fitted and the end held out       thresholds::longest_fitted
///   2  kinds, tolerances, dead and missing channels, units and signs           validation.hpp, unit_check.hpp
///   3  z_r and zdd_r fused, or zdd_r explained like any other channel          input_fusion.hpp
///   4  noise, holds, clipped samples, the windows to fit and to hold out       prepared_recording.hpp
///
/// InputError in one line where the recordings cannot be used.
[[nodiscard]] PreparedData prepare(const firmware::RigDescription& description, std::vector<Record> records);

}  // namespace host_sim::identification
