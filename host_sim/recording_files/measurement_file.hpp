// Measurement files of any kind that rigtwin reads: which kind a file is, and its contents as a table.
#pragma once

#include <filesystem>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"
#include "host_sim/recording_files/text/text_table.hpp"

namespace host_sim {

enum class FileKind : unsigned char { text, matlab, matlab_4, hdf5, tdms, universal, rpc, mdf, mcap, workbook };

/// By the first bytes: "TDSm"; "MDF"; that of MCAP; a zip archive with a workbook; the first record of RPC III; MATLAB 4, 5 or 7.3; the signature of HDF5 at 0, 512,
/// 1024 … bytes; the first lines of a universal file; else text.
[[nodiscard]] FileKind kind_of_file(const std::filesystem::path& file, std::string_view head, bool is_matlab);

/// Whether text is a recording as the contract has it: own files by their mark; else commas, `t` and a known channel
/// (by name or [channels]) in the first line that is no comment, units in SI, and a first row of as many plain numbers.
/// Such text is left to firmware/recording, so that the controller and the workbench read the same file alike.
[[nodiscard]] bool is_contract_csv(std::string_view text, const firmware::ChannelMap& map);

/// Whether read_measurement() takes the bytes of such a file; the others are read from the disk by their libraries.
[[nodiscard]] constexpr bool is_read_whole(FileKind kind) {
  return kind != FileKind::matlab && kind != FileKind::hdf5 && kind != FileKind::workbook;
}

/// The contents of a file that has not that form. `bytes`: those of the file if is_read_whole().
/// `skip`: lines of text at the begin that are not looked at; `progress`: of a text.
[[nodiscard]] RawTable read_measurement(const std::filesystem::path& file, FileKind kind, std::string_view bytes,
                                        std::size_t skip = 0, const ReadingProgress& progress = {});

/// The error for a file that is neither text nor of a kind that is read: it says what the file is ("this is a gzip
/// archive") and what to do with it.
[[nodiscard]] firmware::InputError unknown_kind(const std::filesystem::path& file, std::string_view head);

}  // namespace host_sim
