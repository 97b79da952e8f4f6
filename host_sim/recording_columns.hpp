// How the columns of a file, whatever its format, become the quantities of a recording. For the readers.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/recording.hpp"

namespace host_sim {

/// A quantity that a recording may hold, by number: 0 time, then the channels, then the ducts.
using Quantity = std::size_t;
inline constexpr Quantity time_quantity = 0;
inline constexpr Quantity first_duct = 1 + model::channel_count;
inline constexpr std::size_t quantity_count = first_duct + recorded_ducts;

[[nodiscard]] std::string_view name(Quantity quantity);
[[nodiscard]] std::string_view unit(Quantity quantity);
[[nodiscard]] std::optional<Quantity> find_quantity(std::string_view name);
[[nodiscard]] std::vector<double>& values(Recording& recording, Quantity quantity);
[[nodiscard]] const std::vector<double>& values(const Recording& recording, Quantity quantity);

/// The heading of a column: "F_w [N]" has text "F_w [N]", name "F_w", unit "N".
struct Heading {
  std::string text;
  std::string name;
  std::optional<std::string> unit;
};
[[nodiscard]] Heading read_heading(std::string_view text);

/// Where the values of one column of a file go:   value = scale × column + offset.
struct Target {
  Quantity quantity;
  double scale = 1.0;
  double offset = 0.0;

  [[nodiscard]] double value(double column) const {
    return scale == 1.0 && offset == 0.0 ? column : scale * column + offset;  // −0 stays −0
  }
};

/// Which column is what: an entry of the map first, then the quantities' own names. Columns without a target are
/// ignored. InputErrors (at `line` of the file): no column t, no known channel, two columns for one quantity, two
/// quantities from one column, a unit that is not the SI unit.
[[nodiscard]] std::vector<std::optional<Target>> find_targets(const std::vector<Heading>& headings,
                                                              const ChannelMap& map, std::string_view source,
                                                              std::size_t line);

/// What is wrong with one value of a quantity, and what is expected: both empty when nothing is.
struct Objection {
  std::string wrong;
  std::string_view expected;
  [[nodiscard]] explicit operator bool() const { return !wrong.empty(); }
};
[[nodiscard]] Objection object_to(Quantity quantity, double value);

/// Where a sample of a recording stands in its file, for messages.
struct Place {
  std::string_view source;
  std::size_t first_line = 0;  ///< line of the first sample; 0 where samples have no lines

  /// An InputError about sample k.
  [[nodiscard]] InputError error(std::size_t k, std::string_view wrong, std::string_view expected) const;
};

/// How coarsely the time stamps of a file were printed.
struct StampRounding {
  int decimals = 17;            ///< most decimals of any stamp
  int significant_digits = 17;  ///< most significant digits of any stamp
  double scale = 1.0;           ///< [s / unit of the stamps]
};

/// An InputError unless each time is later than the one before.
void check_time_rises(const Recording& recording, const Place& place);

/// The checks of read_recording on `time`; sets the sample period.
void check_time(Recording& recording, const StampRounding& rounding, const Place& place,
                std::optional<double> expected_rate);

/// Reads an opened CSV file of which the first bytes, `head`, have been taken, in blocks of `block` bytes.
[[nodiscard]] Recording read_recording_csv(int descriptor, std::string_view head, std::string_view source,
                                           const ChannelMap& map, std::optional<double> expected_rate,
                                           std::size_t block = std::size_t{1} << 20U);

/// read_recording for a program without MATLAB files: those are an InputError.
[[nodiscard]] Recording read_csv_recording(const std::filesystem::path& file, const ChannelMap& map,
                                           std::optional<double> expected_rate);

/// The column with the ages of a channel's samples: "age_F".
[[nodiscard]] std::string age_name(model::Channel channel);

/// A CSV recording row by row as it stands in the file, for a replay: times must rise and nothing else; a controller's
/// nan are kept, its gaps are not filled.
struct AsRecorded {
  Recording recording;
  std::vector<double> late;  ///< of each row of a controller's recording [s]; empty: anybody else's
  /// Of each sample of a controller's recording [s], nan where none came; empty: not on record.
  std::array<std::vector<double>, model::channel_count> age;
};
[[nodiscard]] AsRecorded read_csv_as_recorded(const std::filesystem::path& file, const ChannelMap& map);

/// Hands the CSV text over piece by piece: of an hour it is more than the recording itself.
void format_recording_csv(const Recording& recording, const std::function<void(std::string_view)>& take);

/// MATLAB files.
[[nodiscard]] Recording read_recording_mat(const std::filesystem::path& file, const ChannelMap& map,
                                           std::optional<double> expected_rate);
void write_recording_mat(const std::filesystem::path& file, const Recording& recording);

/// The number with as few digits as tell it from its neighbours.
[[nodiscard]] std::string shortest(double value);

}  // namespace host_sim
