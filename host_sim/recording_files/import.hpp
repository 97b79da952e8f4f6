// A measurement file of another program, brought into a recording once and for all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/tables/interpretation.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"
#include "host_sim/recording_files/text/text_table.hpp"

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

/// What a user says of a file beside the rig description.
struct ImportChoices {
  std::vector<std::string> maps;    ///< "F=Kraft [kN]", "x_act=CHANNEL0 * 0.01 + 0.2"
  std::optional<double> rate;       ///< [Hz] the rows are samples at this rate
  std::optional<std::string> time;  ///< "Zeit 2", "Time [ms]": the column that is the time
  std::size_t skip = 0;             ///< lines of text at the begin that are not looked at
  std::optional<double> from, to;   ///< [s] the part of the recording that is kept
  ReadingProgress progress{};       ///< of a long text
};

/// A file as read: as recorded, that is with NaN where a value is missing and without the rows that are missing.
struct Import {
  firmware::Recording recording;
  std::string format;
  std::vector<ImportedColumn> columns;
  std::vector<std::string> notes;
  std::vector<LeftOut> left_out;  ///< everything of the file that is not in the recording
  firmware::ChannelMap channels;  ///< entries of [channels] that say the same
};

/// Reads a file of any kind; columns that are no channel are kept as extra columns, in SI units where their unit is
/// known. InputErrors: those of the readers, a column of the choices that the file has not. UsageError: a choice that
/// is not understood.
///
///   value in SI = (column × factor + offset) × unit,   "CHANNEL=COLUMN [unit] * factor + offset"; without a unit and a
///                                                      factor the unit of the heading counts
[[nodiscard]] Import import_file(const std::filesystem::path& file, const RigContext& rig,
                                 const ImportChoices& choices = {});

/// One column of a file and what it would be taken for.
struct ListedColumn {
  std::string name;              ///< as --map and [channels] name it
  std::string unit;              ///< of the file; empty: none stated
  std::size_t count = 0;         ///< numbers
  std::optional<double> rate;    ///< [Hz]; nullopt: no time is known
  double low = 0.0, high = 0.0;  ///< in the unit of the file
  double rms = 0.0;
  std::vector<double> first;  ///< up to three values
  std::string quantity;       ///< "F", "t"; empty: none
  std::string reason;         ///< of a guess
};

struct FileListing {
  std::string format;
  std::vector<ListedColumn> columns;
  std::vector<LeftOut> left_out;
  std::vector<std::string> notes;
};

/// All columns of a file, without a recording of it. InputErrors: those of the readers.
[[nodiscard]] FileListing list_file(const std::filesystem::path& file, const RigContext& rig,
                                    const ImportChoices& choices = {});

/// The text of a rig description with these entries in its table [channels]: entries of the same quantity are replaced,
/// others stay, as does everything else with its comments.
[[nodiscard]] std::string with_channels(const std::string& description, const firmware::ChannelMap& channels,
                                        const std::string& comment);

}  // namespace host_sim
