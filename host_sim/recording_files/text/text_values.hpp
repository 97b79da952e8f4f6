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

/// A number with at most one decimal sign and without thousands separators: the usual field.
struct PlainNumber {
  double value = 0.0;
  bool has_sign = false;  ///< a decimal sign
  int places = 0;         ///< digits behind the sign
  int decimals = 0;       ///< as in TextNumber
  int significant_digits = 0;
};

/// Reads one at the begin of the text, fast. The end of what was read; nullptr: it is none, and read_text_number() may
/// know it.
[[nodiscard]] const char* read_plain_number(const char* begin, const char* end, char decimal, PlainNumber& number);

/// A number with its unit behind it, "0.5 mm" or "0.001 sec"; nullopt: not one, or no known unit.
struct NumberWithUnit {
  TextNumber number;
  std::string_view unit;
};
[[nodiscard]] std::optional<NumberWithUnit> read_number_with_unit(std::string_view field, char decimal);

/// 9.91e37, by which instruments of the SCPI standard (1999, 7.2.1.5) say that there is no value; 9.9e37 is infinite.
[[nodiscard]] bool is_number_for_missing(double value);

/// Whether the digits are a date and a time: "20240312100000.250".
[[nodiscard]] bool is_compact_stamp(std::string_view field);

/// What one field says of its decimal sign.
enum class DecimalEvidence : unsigned char {
  none,       ///< no sign: a whole number, or no number
  point,      ///< "0.5", "1,234.5", "12,345,678"
  comma,      ///< the same the other way round
  ambiguous,  ///< "1,234": one and a quarter, or a thousand
};
[[nodiscard]] DecimalEvidence decimal_evidence(std::string_view field);

/// Whether the field says that there is no value: empty, NaN, n/a, -, --, #NV, #DIV/0!, 1.#QNAN, null …
[[nodiscard]] bool is_missing_value(std::string_view field);

/// A date or time of day.
struct ClockTime {
  double seconds;  ///< [s] of the day
  long day;        ///< since 1970-01-01; 0 without a date
  bool has_date;
  bool has_time;
  int decimals;            ///< of the seconds
  double wraps = 86400.0;  ///< [s] after which it begins anew: an hour where it has minutes and seconds alone
};

/// "14:05:36.674", "2:05:36,674 PM", "29.06.2022 14:05:36", "06/29/2022 04:05:36.674 PM", "2022-06-29T14:05:36.674Z",
/// "2022-06-29 14:05", "12-Mar-2024 14:05:36", "11:59:59.000 a.m.", "00:55.000" (minutes and seconds), "25:00:00"
/// (hours since the start),
/// "0 days 00:00:01", "20240312T100000.250Z". The decimal sign may be '.' or ',', and ':' before three digits of milliseconds. A date
/// alone counts as well. Dates with strokes are month/day/year unless the first number is above 12.
[[nodiscard]] std::optional<ClockTime> read_clock_time(std::string_view field);

}  // namespace host_sim
