// Numbers, dates and times of day as text in a table's fields.
#pragma once

#include <optional>
#include <string_view>

namespace host_sim {

/// How a number is written; `weak` where it needed thousands separators and might be meant otherwise.
struct TextNumber {
  double value;
  bool weak = false;
  int decimals = 0;  ///< printed, without trailing zeros
  int significant_digits = 0;
};

/// A field as a number with this decimal sign ('.' or ','). Thousands separators (the other sign, a blank, an
/// apostrophe) only in groups of three. nullopt: not a number.
[[nodiscard]] std::optional<TextNumber> read_text_number(std::string_view field, char decimal);

/// Whether the field says that there is no value: empty, NaN, n/a, -, --, #NV, #DIV/0!, 1.#QNAN, null …
[[nodiscard]] bool is_missing_value(std::string_view field);

/// A date or time of day.
struct ClockTime {
  double seconds;  ///< [s] of the day
  long day;        ///< since 1970-01-01; 0 without a date
  bool has_date;
  bool has_time;
  int decimals;  ///< of the seconds
};

/// "14:05:36.674", "2:05:36,674 PM", "29.06.2022 14:05:36", "06/29/2022 04:05:36.674 PM", "2022-06-29T14:05:36.674Z",
/// "2022-06-29 14:05". The decimal sign may be '.' or ',', and ':' before three digits of milliseconds. A date alone
/// counts as well. Dates with strokes are month/day/year unless the first number is above 12.
[[nodiscard]] std::optional<ClockTime> read_clock_time(std::string_view field);

}  // namespace host_sim
