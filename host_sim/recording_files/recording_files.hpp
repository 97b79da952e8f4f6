// Recordings in all formats that rigtwin reads and writes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "host_sim/recording_files/text/text_table.hpp"
#include "model/components/channel.hpp"

namespace host_sim {

/// Reads a recording; the content decides the format. CSV and MATLAB files of the contract's form are read as they
/// stand. Other files – text of other programs, structures in MATLAB files, NI TDMS, HDF5, universal files – are
/// interpreted first (tables/interpretation.hpp): units are converted, and a name that is no channel's is guessed.
/// Every such step stands in the recording's remark. InputError unless:
///
///   values     each used value is finite; ducts are 0 or 1; rows are complete
///   time       increases; each step is T ± (q + 10⁻³ T), their mean T ± 10⁻⁴ T, where T = 1/expected_rate and q is
///              the rounding of the stamps as printed (0 where T is a multiple of it). 10⁻³ T of jitter is an error of
///              2π f · 10⁻³ T ≈ 1.6·10⁻⁴ in a signal of f = 25 Hz at 1 kHz, as large as that of a simulation; 10⁻⁴
///              is the tolerance of a quartz clock; a missing sample is a step of 2 T.
///   units      a unit in a header is one of the quantity's dimension, unless the map has an entry with a scale
///
/// Without expected_rate T is the mean step of the recording. A file written by rigtwin is marked in its first comment
/// (recording_mark); the map is not applied to it. A file written by rig_controller has a column `late`: late periods
/// that it explains are not gaps (firmware/recording/recording_gaps.hpp), and an incomplete last row (loss of power) is
/// left out.
[[nodiscard]] firmware::Recording read_recording(const std::filesystem::path& file,
                                                 const firmware::ChannelMap& map = {},
                                                 std::optional<double> expected_rate = std::nullopt);

/// The same for an analysis that can leave samples out: values that are NaN and rows that are missing, up to 5 % of the
/// rows and 10 % with long gaps, are marked (Recording::filled), and a recording with gaps beyond 20 ms comes in parts
/// (firmware/recording/recording_gaps.hpp). The remark of the first part says what was left out. The recording may run
/// at another rate than `usual_rate`, the rig's, which only counts where it is that one (firmware::rate_if_usual); its
/// grid may be rounded (firmware::recover_grid). The kind of the rig serves the guesses. In files of other programs
/// short rows and values that are no numbers are left out as missing ones are.
[[nodiscard]] std::vector<firmware::Recording> read_parts(const std::filesystem::path& file,
                                                          const firmware::ChannelMap& map = {},
                                                          std::optional<double> usual_rate = std::nullopt,
                                                          std::optional<model::RigKind> kind = std::nullopt);

/// The two ends of a long recording, each in parts as read_parts gives them.
struct PartsOfEnds {
  std::vector<firmware::Recording> first, last;
  double seconds;  ///< from its first to its last row [s]
};

/// The first and the last seconds of a CSV file of the contract's form, for an analysis that uses no more of it: of an
/// hour, all values take a gigabyte and most of the time. nullopt: the file is another one, shorter, or wrong at one of
/// its ends; read_parts() reads it or tells why not.
[[nodiscard]] std::optional<PartsOfEnds> read_parts_of_ends(const std::filesystem::path& file,
                                                            const firmware::ChannelMap& map,
                                                            std::optional<double> usual_rate, double first, double last,
                                                            std::size_t least_size = firmware::long_recording);

/// Writes all columns present, `t` first, by the ending of the name: .mat MATLAB 5, .mcap MCAP with JSON messages,
/// .uff and .unv universal file, .rsp, .drv and .tim RPC III, .mf4 MDF 4.10, .tsv and .de.csv text for spreadsheet
/// programs (with decimal point and comma), else CSV. Texts have the shortest decimals that read back to the same bits.
/// The file appears complete or not at all (firmware/recording/output_file.hpp); "-" is standard output, as CSV.
/// OutputError if it cannot be written or has another ending. `progress`: of CSV, by the share written.
void write_recording(const std::filesystem::path& file, const firmware::Recording& recording,
                     const ReadingProgress& progress = {});

/// OutputError for a name with an ending that write_recording() does not know; a name without one is CSV. Commands call
/// it before they begin to work.
void refuse_unknown_ending(const std::filesystem::path& file);

}  // namespace host_sim
