// Recordings as MATLAB files.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "host_sim/recording_files/binary/isolated_reader.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// All variables of a MATLAB 5 or 7.3 file; InputError if there is none.
[[nodiscard]] std::vector<Leaf> read_mat_leaves(const std::filesystem::path& file);

/// Whether the file has the form of the contract: one vector per channel under its own name or one of the map, also as
/// fields of one structure.
[[nodiscard]] bool is_contract_mat(const std::filesystem::path& file, const std::vector<Leaf>& leaves,
                                   const firmware::ChannelMap& map);

/// A file of that form. The checks are those of read_recording().
[[nodiscard]] firmware::Recording read_recording_mat(const std::filesystem::path& file, std::vector<Leaf> leaves,
                                                     const firmware::ChannelMap& map,
                                                     std::optional<double> expected_rate,
                                                     firmware::Missing missing = firmware::Missing::refuse);

/// Any other file as a table (binary/leaf_table.hpp); InputError if it holds no time.
[[nodiscard]] RawTable table_of_mat(const std::filesystem::path& file, const std::vector<Leaf>& leaves);

void write_recording_mat(const std::filesystem::path& file, const firmware::Recording& recording);

}  // namespace host_sim
