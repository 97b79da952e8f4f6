// Measurement files of any kind that rigtwin reads: which kind a file is, and its contents as a table.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

enum class FileKind : unsigned char { text, matlab, matlab_4, hdf5, tdms, universal, rpc, mdf };

/// By the first bytes: "TDSm"; "MDF"; the first record of RPC III; MATLAB 4, 5 or 7.3; the signature of HDF5 at 0, 512,
/// 1024 … bytes; the first lines of a universal file; else text.
[[nodiscard]] FileKind kind_of_file(const std::filesystem::path& file, std::string_view head, bool is_matlab);

/// Whether text is a recording as the contract has it: own files by their mark; else commas, `t` and a known channel
/// (by name or [channels]) in the first line that is no comment, units in SI, and a first row of as many plain numbers.
/// Such text is left to firmware/recording, so that the controller and the workbench read the same file alike.
[[nodiscard]] bool is_contract_csv(std::string_view text, const firmware::ChannelMap& map);

/// Whether read_measurement() takes the bytes of such a file; the others are read from the disk by their libraries.
[[nodiscard]] constexpr bool is_read_whole(FileKind kind) { return kind != FileKind::matlab && kind != FileKind::hdf5; }

/// The contents of a file that has not that form. `bytes`: those of the file if is_read_whole().
/// `skip`: lines of text at the begin that are not looked at.
[[nodiscard]] RawTable read_measurement(const std::filesystem::path& file, FileKind kind, std::string bytes,
                                        std::size_t skip = 0);

/// The error for a file that is neither text nor of a kind that is read: it says what the file is ("this is a gzip
/// archive") and what to do with it.
[[nodiscard]] firmware::InputError unknown_kind(const std::filesystem::path& file, std::string_view head);

/// The whole file. InputError if it cannot be read.
[[nodiscard]] std::string read_whole(int descriptor, std::string_view head, std::string_view source);

}  // namespace host_sim
