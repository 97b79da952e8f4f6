#include "host_sim/recording_files/text/text_values.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"

namespace host_sim {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Length of a thousands separator at the begin of the text: the other sign, blank, no-break blank, apostrophe.
std::size_t separator_length(std::string_view text, char decimal) {
  if (text.empty()) return 0;
  if (text[0] == (decimal == '.' ? ',' : '.') || text[0] == ' ' || text[0] == '\'') return 1;
  if (text.starts_with("\xc2\xa0")) return 2;
  if (text.starts_with("\xe2\x80\xaf") || text.starts_with("\xe2\x80\x99")) return 3;
  return 0;
}

bool equal_lower(std::string_view text, std::string_view lower) {
  return text.size() == lower.size() && std::equal(text.begin(), text.end(), lower.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         });
}

// A run of digits as a whole number, removed from the begin of the text; nullopt where there is none or too many.
std::optional<int> take_number(std::string_view& text, std::size_t most_digits) {
  std::size_t length = 0;
  int value = 0;
  while (length < text.size() && is_digit(text[length]) && length < most_digits)
    value = 10 * value + (text[length++] - '0');
  if (length == 0 || (length < text.size() && is_digit(text[length]))) return std::nullopt;
  text.remove_prefix(length);
  return value;
}

bool take_sign(std::string_view& text, char sign) {
  if (text.empty() || text[0] != sign) return false;
  text.remove_prefix(1);
  return true;
}

// Days since 1970-01-01 in the Gregorian calendar; y/m/d within 1 … 9999, 1 … 12, 1 … 31.
// Source: H. Hinnant, "chrono-compatible low-level date algorithms", days_from_civil.
long days_since_1970(int year, int month, int day) {
  const int y = month <= 2 ? year - 1 : year;
  const int era = y / 400;
  const int year_of_era = y - era * 400;
  const int day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  const int day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return static_cast<long>(era) * 146097 + day_of_era - 719468;
}

// "Mar", "March", "März", "Mai", "Dez": the month at the begin of the text, removed; 0: none.
int take_month_name(std::string_view& text) {
  struct Name {
    std::string_view text;
    int month;
  };
  constexpr std::array<Name, 16> names{{{"jan", 1},
                                        {"feb", 2},
                                        {"mar", 3},
                                        {"m\xc3\xa4r", 3},
                                        {"mrz", 3},
                                        {"apr", 4},
                                        {"may", 5},
                                        {"mai", 5},
                                        {"jun", 6},
                                        {"jul", 7},
                                        {"aug", 8},
                                        {"sep", 9},
                                        {"oct", 10},
                                        {"okt", 10},
                                        {"nov", 11},
                                        {"dec", 12}}};
  std::size_t length = 0;
  while (
      length < text.size() && length < 12 &&
      (std::isalpha(static_cast<unsigned char>(text[length])) != 0 || static_cast<unsigned char>(text[length]) >= 0x80))
    ++length;
  const std::string_view word = text.substr(0, length);
  if (word.size() >= 3 && equal_lower(word.substr(0, 3), "dez")) {
    text.remove_prefix(length);
    return 12;
  }
  for (const Name& name : names) {
    if (word.size() < name.text.size() || !equal_lower(word.substr(0, name.text.size()), name.text)) continue;
    text.remove_prefix(length);
    return name.month;
  }
  return 0;
}

// "12-Mar-2024", "12 March 2024", "Mar 12, 2024"; nullopt: none, and the text stays.
std::optional<long> take_date_with_name(std::string_view& text) {
  std::string_view rest = text;
  const auto pass = [&] {
    std::size_t length = 0;
    while (length < rest.size() && (rest[length] == '-' || rest[length] == ' ' || rest[length] == '.' ||
                                    rest[length] == '/' || rest[length] == ','))
      ++length;
    rest.remove_prefix(length);
    return length > 0;
  };
  std::optional<int> day = take_number(rest, 2);
  if (day && !pass()) return std::nullopt;
  const int month = take_month_name(rest);
  if (month == 0 || !pass()) return std::nullopt;
  if (!day) {
    day = take_number(rest, 2);
    if (!day || !pass()) return std::nullopt;
  }
  std::optional<int> year = take_number(rest, 4);
  if (!year || *day < 1 || *day > 31) return std::nullopt;
  if (*year < 100) *year += *year < 70 ? 2000 : 1900;
  if (*year < 1) return std::nullopt;
  text = rest;
  return days_since_1970(*year, month, *day);
}

// A date at the begin of the text; the text after it remains. nullopt: none, and the text stays.
std::optional<long> take_date(std::string_view& text) {
  std::string_view rest = text;
  if (rest.size() >= 8 && std::all_of(rest.begin(), rest.begin() + 8, is_digit) &&
      (rest.size() == 8 || !is_digit(rest[8]) ||
       (rest.size() >= 14 && std::all_of(rest.begin(), rest.begin() + 14, is_digit)))) {
    // "20240312T100000"
    const auto digits = [&](std::size_t from, std::size_t count) {
      int value = 0;
      for (std::size_t i = from; i < from + count; ++i) value = 10 * value + (rest[i] - '0');
      return value;
    };
    const int month = digits(4, 2), day = digits(6, 2), year = digits(0, 4);
    if (year < 1900 || year > 2199 || month < 1 || month > 12 || day < 1 || day > 31) return std::nullopt;
    text.remove_prefix(8);
    return days_since_1970(year, month, day);
  }
  const std::optional<int> first = take_number(rest, 4);
  if (!first || rest.empty()) return std::nullopt;
  const char sign = rest[0];
  if (sign != '-' && sign != '.' && sign != '/') return std::nullopt;
  rest.remove_prefix(1);
  const std::optional<int> second = take_number(rest, 2);
  if (!second || !take_sign(rest, sign)) return std::nullopt;
  const std::optional<int> third = take_number(rest, 4);
  if (!third) return std::nullopt;
  int year = *third;
  int month = *second;
  int day = *first;
  if (*first > 31) {
    year = *first;
    day = *third;
  } else if (sign == '/' && *first <= 12) {
    month = *first;
    day = *second;
  }
  if (year < 100) year += year < 70 ? 2000 : 1900;
  if (month < 1 || month > 12 || day < 1 || day > 31) return std::nullopt;
  text = rest;
  return days_since_1970(year, month, day);
}

// "1 day, 02:00:00", "0 days 00:00:00.001": the days at the begin, removed; nullopt: none, and the text stays.
std::optional<int> take_days(std::string_view& text) {
  std::string_view rest = text;
  const std::optional<int> days = take_number(rest, 4);
  if (!days || rest.empty() || (rest[0] != ' ' && rest[0] != 'd' && rest[0] != 'D')) return std::nullopt;
  rest = firmware::trimmed(rest);
  for (const std::string_view word : {"days", "day", "Tage", "Tag", "d"}) {
    if (!rest.starts_with(word)) continue;
    rest.remove_prefix(word.size());
    if (!rest.empty() && rest[0] != ' ' && rest[0] != ',') return std::nullopt;
    if (rest.starts_with(',')) rest.remove_prefix(1);
    text = firmware::trimmed(rest);
    return days;
  }
  return std::nullopt;
}

// "100000.250Z" behind a date: hours, minutes, seconds without signs between them.
bool take_compact_time(std::string_view rest, ClockTime& clock) {
  if (rest.size() < 6 || !std::all_of(rest.begin(), rest.begin() + 6, is_digit)) return false;
  const auto two = [&](std::size_t at) { return 10 * (rest[at] - '0') + (rest[at + 1] - '0'); };
  if (two(0) > 24 || two(2) > 59 || two(4) > 60) return false;
  clock.seconds = 3600.0 * two(0) + 60.0 * two(2) + two(4);
  rest.remove_prefix(6);
  if (!rest.empty() && (rest[0] == '.' || rest[0] == ',')) {
    std::string digits = "0.";
    for (rest.remove_prefix(1); !rest.empty() && is_digit(rest[0]); rest.remove_prefix(1)) digits += rest[0];
    clock.decimals = static_cast<int>(digits.size()) - 2;
    clock.seconds += std::strtod(digits.c_str(), nullptr);
  }
  clock.has_time = true;
  return rest.empty() || rest == "Z" || ((rest[0] == '+' || rest[0] == '-') && rest.size() <= 6);
}

}  // namespace

bool is_compact_stamp(std::string_view field) {
  field = firmware::trimmed(field);
  return field.size() >= 14 && (field[0] == '1' || field[0] == '2') &&
         std::all_of(field.begin(), field.begin() + 14, is_digit) &&
         (field.size() == 14 || field[14] == '.' || field[14] == ',') && read_clock_time(field).has_value();
}

std::optional<TextNumber> read_text_number(std::string_view field, char decimal) {
  field = firmware::trimmed(field);
  if (field.empty() || field.size() > 64) return std::nullopt;
  std::string number;
  TextNumber result{0.0};
  std::size_t i = 0;
  if (field[0] == '+' || field[0] == '-') number += field[i++] == '-' ? "-" : "";
  if (field.substr(i).starts_with("\xe2\x88\x92")) {  // the minus sign of typesetting
    number += '-';
    i += 3;
  }
  const std::size_t first_digit = i;
  std::size_t group = 0;
  bool separated = false;
  while (i < field.size()) {
    if (is_digit(field[i])) {
      number += field[i++];
      ++group;
      continue;
    }
    const std::size_t length = separator_length(field.substr(i), decimal);
    const bool three_follow = i + length + 3 <= field.size() && is_digit(field[i + length]) &&
                              is_digit(field[i + length + 1]) && is_digit(field[i + length + 2]) &&
                              (i + length + 3 == field.size() || !is_digit(field[i + length + 3]));
    const bool fits = separated ? group == 3 : group >= 1 && group <= 3 && field[first_digit] != '0';
    if (length == 0 || !three_follow || !fits) break;
    separated = true;
    result.weak = true;
    group = 0;
    i += length;
  }
  std::size_t whole = i - first_digit;
  std::size_t fraction = 0;
  if (i < field.size() && field[i] == decimal) {
    number += '.';
    for (++i; i < field.size() && is_digit(field[i]); ++i, ++fraction) number += field[i];
  }
  if (whole == 0 && fraction == 0) return std::nullopt;
  std::size_t end_of_digits = number.size();
  int exponent = 0;
  if (i < field.size() && (field[i] == 'e' || field[i] == 'E' || field[i] == 'd' || field[i] == 'D')) {
    std::string_view rest = field.substr(i + 1);
    std::string power = "e";
    if (!rest.empty() && (rest[0] == '+' || rest[0] == '-')) {
      power += rest[0];
      rest.remove_prefix(1);
    }
    if (rest.empty() || rest.size() > 4 || !std::all_of(rest.begin(), rest.end(), is_digit)) return std::nullopt;
    power += rest;
    number += power;
    exponent = std::atoi(power.c_str() + 1);
    i = field.size();
  }
  if (i != field.size()) return std::nullopt;
  if (number.front() == '.') number.insert(0, "0");
  if (number.starts_with("-.")) number.insert(1, "0");
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), result.value);
  static_cast<void>(end);
  if (error == std::errc::result_out_of_range) result.value = std::strtod(number.c_str(), nullptr);
  // Trailing zeros say nothing of the resolution: "11.000" is a whole millisecond.
  end_of_digits = std::min(end_of_digits, number.size());
  while (fraction > 0 && number[end_of_digits - 1] == '0') {
    --end_of_digits;
    --fraction;
  }
  result.decimals = static_cast<int>(fraction) - exponent;
  bool leading = true;
  for (std::size_t k = 0; k < end_of_digits; ++k) {
    if (!is_digit(number[k]) || (leading && number[k] == '0')) continue;
    leading = false;
    ++result.significant_digits;
  }
  return result;
}

bool is_number_for_missing(double value) { return std::abs(value) >= 9.9e37 && std::abs(value) <= 9.91e37; }

const char* read_plain_number(const char* begin, const char* end, char decimal, PlainNumber& number) {
  const char* p = begin;
  if (p != end && *p == '+') ++p;
  const char* const signed_begin = p;
  const bool negative = p != end && *p == '-';
  if (negative) ++p;
  const char* const first = p;
  std::uint64_t digits = 0;
  while (p != end && is_digit(*p)) digits = 10 * digits + static_cast<unsigned>(*p++ - '0');
  auto count = p - first;
  number.places = 0;
  number.has_sign = p != end && *p == decimal;
  if (number.has_sign) {
    const char* const fraction = ++p;
    while (p != end && is_digit(*p)) digits = 10 * digits + static_cast<unsigned>(*p++ - '0');
    number.places = static_cast<int>(p - fraction);
    count += number.places;
  }
  if (count == 0) return nullptr;  // words such as "nan" and "inf" are not numbers here
  const char* const end_of_digits = p;
  int exponent = 0;
  if (p != end && (*p == 'e' || *p == 'E')) {
    const char* power = p + 1;
    if (power != end && *power == '+') ++power;
    const auto [stop, error] = std::from_chars(power, end, exponent);
    if (error != std::errc{} || std::abs(exponent) > 400) return nullptr;
    p = stop;
  }
  // Both factors are exact, so the result is the nearest double (W. D. Clinger, "How to read floating point numbers
  // accurately", 1990).
  constexpr std::array<double, 23> powers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                          1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const int ten = exponent - number.places;
  if (count <= 19 && digits <= std::uint64_t{1} << 53U && ten >= -22 && ten <= 22) {
    const auto whole = static_cast<double>(digits);
    const double size =
        ten < 0 ? whole / powers[static_cast<std::size_t>(-ten)] : whole * powers[static_cast<std::size_t>(ten)];
    number.value = negative ? -size : size;
  } else {
    const auto [stop, error] = fast_float::from_chars_advanced(
        signed_begin, p, number.value, fast_float::parse_options{fast_float::chars_format::general, decimal});
    if (stop != p || error != std::errc{} || !std::isfinite(number.value)) return nullptr;
  }
  if (is_number_for_missing(number.value)) return nullptr;
  // Trailing zeros behind the sign say nothing of the resolution: "11.000" is a whole millisecond.
  const char* last = end_of_digits;
  int zeros = 0;
  while (zeros < number.places && last[-1] == '0') {
    --last;
    ++zeros;
  }
  const char* leading = first;
  while (leading != last && (*leading == '0' || *leading == decimal)) ++leading;
  number.decimals = number.places - zeros - exponent;
  const auto shown =
      last - leading - (number.has_sign && leading <= end_of_digits - number.places - 1 && leading != last ? 1 : 0);
  number.significant_digits = static_cast<int>(std::max<std::ptrdiff_t>(shown, 0));
  return p;
}

std::optional<NumberWithUnit> read_number_with_unit(std::string_view field, char decimal) {
  field = firmware::trimmed(field);
  std::size_t end = field.size();
  // The unit is what stands behind the last digit; exponents of units ("m/s2") are tried, too.
  std::size_t first = field.find_first_not_of("0123456789.,+- eE");
  if (first == std::string_view::npos || first == 0 || field.size() > 48) return std::nullopt;
  while (first > 0 && (field[first - 1] == 'e' || field[first - 1] == 'E' || field[first - 1] == '-')) --first;
  const std::string_view unit = firmware::trimmed(field.substr(first, end - first));
  if (!firmware::is_unit(unit)) return std::nullopt;
  const std::optional<TextNumber> number = read_text_number(field.substr(0, first), decimal);
  if (!number) return std::nullopt;
  return NumberWithUnit{*number, unit};
}

DecimalEvidence decimal_evidence(std::string_view field) {
  std::size_t points = 0;
  std::size_t commas = 0;
  std::size_t last = 0;
  std::size_t first = field.size();
  std::size_t i = 0;
  while (i < field.size() && (field[i] == '+' || field[i] == '-' || field[i] == ' ')) ++i;
  const std::size_t begin = i;
  std::size_t digits = 0;
  for (; i < field.size(); ++i) {
    if (is_digit(field[i])) {
      ++digits;
      continue;
    }
    if (field[i] != '.' && field[i] != ',') break;
    (field[i] == '.' ? points : commas) += 1;
    first = std::min(first, i);
    last = i;
  }
  if (digits == 0 || points + commas == 0) return DecimalEvidence::none;
  if (i < field.size() && field[i] != 'e' && field[i] != 'E' && field[i] != ' ') return DecimalEvidence::none;
  const bool point_last = field[last] == '.';
  const DecimalEvidence by_last = point_last ? DecimalEvidence::point : DecimalEvidence::comma;
  const DecimalEvidence by_other = point_last ? DecimalEvidence::comma : DecimalEvidence::point;
  if (points > 0 && commas > 0) return by_last;
  if (points + commas > 1) return by_other;  // two equal signs separate thousands
  const std::size_t before = first - begin;
  const std::size_t after = i - last - 1;
  const bool thousands = after == 3 && before >= 1 && before <= 3 && field[begin] != '0' && i == field.size();
  return thousands ? DecimalEvidence::ambiguous : by_last;
}

bool is_missing_value(std::string_view field) {
  field = firmware::trimmed(field);
  // Microsoft's C library prints 1.#QNAN0, -1.#INF00, 1.#IND.
  if (field.starts_with("1.#") || field.starts_with("-1.#")) return true;
  // Only words are looked for: a digit first, and it is a number, or none of ours.
  if (!field.empty() && is_digit(field.front())) return false;
  constexpr std::array<std::string_view, 47> words{
      "inf",    "-inf",       "+inf",   "infinity", "-infinity", "\xe2\x88\x9e", "-\xe2\x88\x9e", "+\xe2\x88\x9e",
      "<na>",   "nan(snan)",  "ol",     "over",     "overflow",  "overload",     "ovld",          "#bezug!",
      "#zahl!", "#ref!",      "#num!",  "#name?",   "#null!",    "invalid",      "no data",       "nodata",
      "nil",    "-nan(snan)", "",       "nan",      "-nan",      "+nan",         "nan(ind)",      "-nan(ind)",
      "n/a",    "na",         "n.a.",   "-",        "--",        "---",          "----",          "#n/a",
      "#nv",    "#div/0!",    "#wert!", "#value!",  "null",      "none",         "missing"};
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) { return equal_lower(field, word); });
}

std::optional<ClockTime> read_clock_time(std::string_view field) {
  field = firmware::trimmed(field);
  if (field.size() < 5 || field.size() > 40) return std::nullopt;
  ClockTime clock{0.0, 0, false, false, 0};
  std::string_view rest = field;
  const std::optional<int> whole_days = take_days(rest);
  std::optional<long> days = whole_days ? std::nullopt : take_date(rest);
  if (!days && !whole_days) days = take_date_with_name(rest);
  if (days) {
    clock.has_date = true;
    clock.day = *days;
    if (!rest.empty() && (rest[0] == 'T' || rest[0] == ' ' || rest[0] == '_' || rest[0] == ',')) {
      rest.remove_prefix(1);
      rest = firmware::trimmed(rest);
    }
    if (rest.empty()) return clock;
  }
  if (clock.has_date && take_compact_time(rest, clock)) return clock;
  // Hours beyond a day count from the start of a run.
  const std::optional<int> hours = take_number(rest, clock.has_date ? 2 : 4);
  if (!hours || !take_sign(rest, ':')) return std::nullopt;
  const std::optional<int> minutes = take_number(rest, 2);
  if (!minutes || (clock.has_date && *hours > 24) || *minutes > 59) return std::nullopt;
  int seconds = 0;
  double fraction = 0.0;
  const auto take_fraction = [&] {
    std::string digits = "0.";
    while (!rest.empty() && is_digit(rest[0])) {
      digits += rest[0];
      rest.remove_prefix(1);
      ++clock.decimals;
    }
    fraction = std::strtod(digits.c_str(), nullptr);
    return clock.decimals > 0;
  };
  bool minutes_first = false;
  if (take_sign(rest, ':')) {
    const std::optional<int> whole = take_number(rest, 2);
    if (!whole || *whole > 60) return std::nullopt;
    seconds = *whole;
    if (!rest.empty() && (rest[0] == '.' || rest[0] == ',' || rest[0] == ':')) {
      rest.remove_prefix(1);
      if (!take_fraction()) return std::nullopt;
    }
  } else if (!clock.has_date && rest.size() > 1 && (rest[0] == '.' || rest[0] == ',') && is_digit(rest[1])) {
    // "00:55.000": minutes and seconds.
    rest.remove_prefix(1);
    take_fraction();
    minutes_first = true;
    clock.wraps = 3600.0;
  }
  clock.has_time = true;
  int hour = *hours;
  rest = firmware::trimmed(rest);
  std::string half;  // of the day: "am", "a.m."
  std::size_t half_length = 0;
  for (; half_length < rest.size() && half_length < 4 && rest[half_length] != '+' && rest[half_length] != ' ';
       ++half_length) {
    if (rest[half_length] != '.')
      half += static_cast<char>(std::tolower(static_cast<unsigned char>(rest[half_length])));
  }
  if (!minutes_first && (half == "am" || half == "pm")) {
    if (hour > 12) return std::nullopt;
    hour = hour % 12 + (half == "pm" ? 12 : 0);
    rest = firmware::trimmed(rest.substr(half_length));
  }
  // A zone moves all stamps alike.
  const bool zone =
      rest.empty() || rest == "Z" || rest == "UTC" || ((rest[0] == '+' || rest[0] == '-') && rest.size() <= 6);
  if (!zone) return std::nullopt;
  clock.seconds =
      minutes_first ? 60.0 * hour + *minutes + fraction : 3600.0 * hour + 60.0 * *minutes + seconds + fraction;
  clock.seconds += 86400.0 * whole_days.value_or(0);
  return clock;
}

}  // namespace host_sim
