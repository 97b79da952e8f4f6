// A recording: equally spaced samples of a rig's channels, as CSV and MATLAB files hold them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/quantity.hpp"
#include "model/components/channel.hpp"

namespace firmware {

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
  std::vector<ExtraColumn> extra;                                  ///< written only; readers leave it empty
  std::vector<std::string> comments;                               ///< written above the header of a CSV file
  std::string source;                                              ///< file name as given by the user
  std::vector<bool> filled;   ///< rows that were not recorded completely, see recording_gaps.hpp; empty: none
  std::string remark;         ///< one line on late periods and filled rows; empty: none
  std::size_t lost_rows = 0;  ///< rows of the file that are missing or incomplete, in all parts of it
  struct Gap {
    double from, to;  ///< t of the rows before and after [s]
  };
  std::vector<Gap> gaps;                     ///< of more than 20 ms, in all parts of the file
  std::vector<std::string> ignored_columns;  ///< header texts of the columns not understood

  [[nodiscard]] std::size_t size() const { return time.size(); }
  [[nodiscard]] bool has(model::Channel channel) const { return !channels[model::index(channel)].empty(); }
  [[nodiscard]] const std::vector<double>& operator[](model::Channel channel) const {
    return channels[model::index(channel)];
  }
  [[nodiscard]] std::vector<double>& operator[](model::Channel channel) { return channels[model::index(channel)]; }

  /// The channel's samples, or an InputError that names the purpose for which they are needed ("to drive the
  /// simulation").
  [[nodiscard]] const std::vector<double>& required(model::Channel channel, std::string_view purpose) const;

  /// The same file, comments, remark and gaps, without samples: the begin of a recording derived from this one.
  [[nodiscard]] Recording without_samples() const;
};

/// The column of a quantity; empty when absent.
[[nodiscard]] std::vector<double>& values(Recording& recording, Quantity quantity);
[[nodiscard]] const std::vector<double>& values(const Recording& recording, Quantity quantity);

/// Time stamps k/rate for k = first … first + count − 1: the doubles nearest to the exact instants, which print
/// shortest.
[[nodiscard]] std::vector<double> sample_times(std::size_t count, double rate, std::size_t first = 0);

/// The comment that marks a recording written by rigtwin. [channels] describes names, scales and signs in recordings of
/// *other* programs and is not applied to marked recordings.
inline constexpr std::string_view recording_mark = "rigtwin recording: SI units";

}  // namespace firmware
