// A run of the rig: which drive it belongs to, and what is left of it.
#pragma once

#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/replicate/target.hpp"

namespace host_sim::replicate {

/// A drive that was made, and the SHA-256 of its file.
struct Drive {
  std::vector<double> values;  ///< [m]
  std::string file;            ///< name in the folder
  std::string sha256;
};

/// What a run measured, sample by sample of its drive.
struct RunRecord {
  std::vector<std::vector<double>> measured;  ///< by channel of the target; empty: lost
  std::size_t samples = 0;                    ///< of the drive that were run
  std::vector<std::string> remarks;           ///< a channel that is lost, a run that was cut short
};

/// The recorded command tells which drive a run belongs to: the newest must be it. InputError where it belongs to
/// another drive or to none, was cut short before half of the first event, or holds no channel of the target.
[[nodiscard]] RunRecord read_run(const firmware::RigDescription& description, const Target& target,
                                 const std::vector<Drive>& drives, const firmware::Recording& recording);

}  // namespace host_sim::replicate
