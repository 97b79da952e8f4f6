// Recordings as MATLAB files.
#pragma once

#include <filesystem>
#include <optional>

#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_gaps.hpp"

namespace host_sim {

/// MATLAB 5 and 7.3 files. The checks are those of read_recording().
[[nodiscard]] firmware::Recording read_recording_mat(const std::filesystem::path& file, const firmware::ChannelMap& map,
                                                     std::optional<double> expected_rate,
                                                     firmware::Missing missing = firmware::Missing::refuse);
void write_recording_mat(const std::filesystem::path& file, const firmware::Recording& recording);

}  // namespace host_sim
