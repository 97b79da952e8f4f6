// Checks of a recording's samples and time stamps, the same for every file format.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/recording/recording.hpp"

namespace firmware {

/// Error of one value of a quantity and the expected value; both empty if the value is valid.
struct Objection {
  std::string wrong;
  std::string_view expected;
  [[nodiscard]] explicit operator bool() const { return !wrong.empty(); }
};
[[nodiscard]] Objection object_to(Quantity quantity, double value);

/// Position of the samples of a recording in its file, for messages.
struct RecordingLocation {
  std::string_view source;
  std::size_t first_line = 0;  ///< line of the first sample; 0 where samples have no lines

  /// An InputError about sample k.
  [[nodiscard]] InputError error(std::size_t k, std::string_view wrong, std::string_view expected) const;
};

/// Resolution of the printed time stamps of a file.
struct StampRounding {
  int decimals = 17;            ///< most decimals of any stamp
  int significant_digits = 17;  ///< most significant digits of any stamp
  double scale = 1.0;           ///< [s / unit of the stamps]
};

/// The median of the differences between successive times; there are two times at least.
[[nodiscard]] double median_step(const std::vector<double>& time);

/// The rate of a recording that may run at any: `usual` where the median step is that of this rate up to 1e-4 (the
/// tolerance of a quartz clock) and the rounding of the stamps; nullopt: a rate of its own.
[[nodiscard]] std::optional<double> rate_if_usual(const std::vector<double>& time, const StampRounding& rounding,
                                                  std::optional<double> usual);

/// Replaces stamps that are too coarse for their steps (whole milliseconds at 97 Hz) by the grid that all of them
/// together show, t₀ + n T by regression on the row numbers n, and says so in the remark:
///
///   (1)  |t_k − t₀ − n_k T| ≤ q  for every k,   q: rounding of the stamps, at most T/1.75
///
/// false: nothing changed, since the stamps are exact, do not rise, or (1) does not hold.
bool recover_grid(Recording& recording, const StampRounding& rounding, std::optional<double> usual_rate);

/// Rounding of times as large as `largest` [s], printed or kept in single precision; 0 where `period` is a multiple of
/// it.
[[nodiscard]] double stamp_error(const std::vector<double>& time, const StampRounding& rounding, double period);

/// An InputError unless each time is later than the one before.
void check_time_rises(const Recording& recording, const RecordingLocation& location);

/// The checks of read_recording() on `time`; sets the sample period.
void check_time(Recording& recording, const StampRounding& rounding, const RecordingLocation& location,
                std::optional<double> expected_rate);

}  // namespace firmware
