// Recordings as CSV text: read with every check, written with the shortest decimals that read back to the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "firmware/recording/run_columns.hpp"

namespace firmware {

/// Reads CSV text in memory, with the checks of host_sim/recording_files; `source` names it in messages.
[[nodiscard]] Recording parse_recording_csv(std::string_view text, std::string_view source, const ChannelMap& map = {},
                                            std::optional<double> expected_rate = std::nullopt,
                                            Missing missing = Missing::refuse);

/// Reads an opened CSV file in blocks of `block` bytes; its first bytes, `head`, have been read already.
[[nodiscard]] Recording read_recording_csv(int descriptor, std::string_view head, std::string_view source,
                                           const ChannelMap& map, std::optional<double> expected_rate,
                                           Missing missing = Missing::refuse,
                                           std::size_t block = std::size_t{1} << 20U);

/// [bytes] A text from here on takes a quarter of a second to read.
inline constexpr std::size_t long_recording = std::size_t{64} << 20U;

/// The two ends of a long recording.
struct RecordingEnds {
  Recording first, last;
  double seconds;  ///< from its first to its last row [s]
};

/// The first and the last seconds of an opened CSV file of at least `least_size` bytes; what is between is neither read
/// nor checked, and what is missing in them is marked (Missing::mark). nullopt: read it whole, since it is short, no
/// file on a disk, not as long as both together, or wrong at one of its ends (the whole reading tells the line).
[[nodiscard]] std::optional<RecordingEnds> read_recording_ends(int descriptor, std::string_view source,
                                                               const ChannelMap& map,
                                                               std::optional<double> expected_rate, double first,
                                                               double last, std::size_t least_size = long_recording);

/// Reads a CSV file; a MATLAB file is an InputError. For programs without the MATLAB reader.
[[nodiscard]] Recording read_csv_recording(const std::filesystem::path& file, const ChannelMap& map,
                                           std::optional<double> expected_rate);

/// A CSV recording with its rows exactly as in the file, for a replay. Times must increase; no other check is made. NaN
/// of a controller's recording are kept, gaps are not filled.
struct AsRecorded {
  Recording recording;
  std::vector<double> late;  ///< lateness of each row of a controller's recording [s]; empty for other recordings
  /// Age of each sample of a controller's recording [s], NaN without a sample; empty: not recorded.
  std::array<std::vector<double>, model::channel_count> age;
  /// Of each row, as numbers (run_columns); empty: the recording holds nothing but the run.
  std::vector<double> mode;
  std::vector<double> reason;
  std::vector<double> level;
};
[[nodiscard]] AsRecorded read_csv_as_recorded(const std::filesystem::path& file, const ChannelMap& map);

/// Passes the CSV text to `take` in pieces, because the text is larger than the recording in memory.
/// `progress` is told the share that has been passed.
void format_recording_csv(const Recording& recording, const std::function<void(std::string_view)>& take,
                          const std::function<void(double)>& progress = {});

/// The CSV text that write_recording writes.
[[nodiscard]] std::string format_recording_csv(const Recording& recording);

}  // namespace firmware
