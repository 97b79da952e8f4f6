// A recording: equally spaced samples of a rig's channels, read from and written to CSV and MATLAB files.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/channel_map.hpp"
#include "host_sim/input_error.hpp"
#include "model/channel.hpp"

namespace host_sim {

inline constexpr std::size_t recorded_ducts = 6;

/// A column beside those of the contract, for writing: a soft sensor, a state number.
struct ExtraColumn {
  std::string name;
  std::string unit;  ///< may be empty
  std::vector<double> values;
};

/// Equally spaced samples in SI units. Each column is as long as `time`, or empty when absent.
struct Recording {
  double sample_period = 0.0;                                      ///< T [s]
  std::vector<double> time;                                        ///< t [s], as recorded; need not start at 0
  std::array<std::vector<double>, model::channel_count> channels;  ///< by model::Channel
  std::array<std::vector<double>, recorded_ducts> ducts;           ///< duct j + 1: 1 open, 0 closed
  std::vector<ExtraColumn> extra;                                  ///< written; what is read never fills it
  std::vector<std::string> comments;                               ///< written above the header of a CSV file
  std::string source;                                              ///< the file, as the user called it
  std::vector<bool> filled;  ///< rows that were not recorded whole, see host_sim/recording_gaps.hpp; empty: none
  std::string remark;        ///< a line on late periods and on what was filled; empty: nothing to say
  std::vector<std::string> ignored_columns;  ///< header texts of the columns not understood

  [[nodiscard]] std::size_t size() const { return time.size(); }
  [[nodiscard]] bool has(model::Channel channel) const { return !channels[model::index(channel)].empty(); }
  [[nodiscard]] const std::vector<double>& operator[](model::Channel channel) const {
    return channels[model::index(channel)];
  }
  [[nodiscard]] std::vector<double>& operator[](model::Channel channel) { return channels[model::index(channel)]; }

  /// The channel's samples, or an InputError that says what they would have been needed for ("to drive the
  /// simulation").
  [[nodiscard]] const std::vector<double>& required(model::Channel channel, std::string_view purpose) const;
};

/// Whether a recording may have a column of this name: "t", a channel, "duct_1" … "duct_6".
[[nodiscard]] bool is_recorded_quantity(std::string_view name);

/// Time stamps k/rate for k = first … first + count − 1: the doubles nearest to the exact instants, which print
/// shortest.
[[nodiscard]] std::vector<double> sample_times(std::size_t count, double rate, std::size_t first = 0);

/// Reads a CSV or MATLAB (5 or 7.3) file, told apart by content. Whatever does not fit is an InputError:
///
///   values     each used value is finite; ducts are 0 or 1; rows are complete
///   time       runs forward; each step is T ± (q + 10⁻³ T), their mean T ± 10⁻⁴ T, where T = 1/expected_rate and q is
///              the rounding of the stamps as printed (0 where T is a multiple of it). 10⁻³ T of jitter is an error of
///              2π f · 10⁻³ T ≈ 1.6·10⁻⁴ in a signal of f = 25 Hz at 1 kHz, that of a simulation; 10⁻⁴ is what a
///              quartz clock may be off; a missing sample is a step of 2 T.
///   units      a unit in a header is the SI unit, unless the map has an entry for the column
///
/// Without expected_rate the recording's own mean step is T. A file that rigtwin wrote says so in its first comment;
/// its channels have their own names and SI units whatever the map says (see recording_mark). One that rig_controller
/// wrote has a column `late` beside it: late periods that it explains are no gaps (host_sim/recording_gaps.hpp), and
/// a last row without its end, cut off by a loss of power, is left out.
[[nodiscard]] Recording read_recording(const std::filesystem::path& file, const ChannelMap& map = {},
                                       std::optional<double> expected_rate = std::nullopt);

/// The same for the text of a CSV file in memory; `source` stands for it in messages.
[[nodiscard]] Recording parse_recording_csv(std::string_view text, std::string_view source, const ChannelMap& map = {},
                                            std::optional<double> expected_rate = std::nullopt);

/// The comment that marks a recording written by rigtwin: [channels] describes how *other* programs' recordings name,
/// scale and sign the channels, and must not turn the sign of a simulated one.
inline constexpr std::string_view recording_mark = "rigtwin recording: SI units";

/// Writes all columns present, `t` first: MATLAB 5 if the name ends in .mat, else CSV with the shortest decimals that
/// read back to the same bits. The file appears complete or not at all (host_sim/output_file.hpp). OutputError if it
/// cannot.
void write_recording(const std::filesystem::path& file, const Recording& recording);

/// The CSV text that write_recording writes.
[[nodiscard]] std::string format_recording_csv(const Recording& recording);

}  // namespace host_sim
