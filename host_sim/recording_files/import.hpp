// A measurement file of another program, brought into a recording once and for all.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/tables/interpretation.hpp"

namespace host_sim {

/// One line of the account of an import.
struct ImportedColumn {
  std::string quantity;  ///< "z_w"; empty: kept under its own name, or left out
  std::string column;    ///< in the file
  std::string unit;      ///< in the file; empty: none
  double scale = 1.0;
  double offset = 0.0;
  std::string reason;  ///< of a guess; empty: by name or [channels]
};

/// A file as read: as recorded, that is with NaN where a value is missing and without the rows that are missing.
struct Import {
  firmware::Recording recording;
  std::string format;
  std::vector<ImportedColumn> columns;
  std::vector<std::string> notes;
  firmware::ChannelMap channels;  ///< entries of [channels] that say the same
};

/// Reads a file of any kind; columns that are no channel are kept as extra columns, in SI units where their unit is
/// known. InputErrors: those of the readers.
[[nodiscard]] Import import_file(const std::filesystem::path& file, const RigContext& rig);

/// The text of a rig description with these entries in its table [channels]: entries of the same quantity are replaced,
/// others stay, as does everything else with its comments.
[[nodiscard]] std::string with_channels(const std::string& description, const firmware::ChannelMap& channels,
                                        const std::string& comment);

}  // namespace host_sim
