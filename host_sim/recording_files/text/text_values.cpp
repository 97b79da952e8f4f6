#include "host_sim/recording_files/text/text_values.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

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

// A date at the begin of the text; the text after it remains. nullopt: none, and the text stays.
std::optional<long> take_date(std::string_view& text) {
  std::string_view rest = text;
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

}  // namespace

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

bool is_missing_value(std::string_view field) {
  field = firmware::trimmed(field);
  constexpr std::array<std::string_view, 24> words{"",     "nan",  "-nan",    "+nan",    "nan(ind)", "-nan(ind)",
                                                   "n/a",  "na",   "n.a.",    "-",       "--",       "---",
                                                   "----", "#n/a", "#nv",     "#div/0!", "#wert!",   "#value!",
                                                   "null", "none", "1.#qnan", "-1.#ind", "1.#ind",   "missing"};
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) { return equal_lower(field, word); });
}

std::optional<ClockTime> read_clock_time(std::string_view field) {
  field = firmware::trimmed(field);
  if (field.size() < 5 || field.size() > 40) return std::nullopt;
  ClockTime clock{0.0, 0, false, false, 0};
  std::string_view rest = field;
  if (const std::optional<long> days = take_date(rest)) {
    clock.has_date = true;
    clock.day = *days;
    if (!rest.empty() && (rest[0] == 'T' || rest[0] == ' ' || rest[0] == '_' || rest[0] == ',')) {
      rest.remove_prefix(1);
      rest = firmware::trimmed(rest);
    }
    if (rest.empty()) return clock;
  }
  const std::optional<int> hours = take_number(rest, 2);
  if (!hours || !take_sign(rest, ':')) return std::nullopt;
  const std::optional<int> minutes = take_number(rest, 2);
  if (!minutes || *hours > 24 || *minutes > 59) return std::nullopt;
  int seconds = 0;
  double fraction = 0.0;
  if (take_sign(rest, ':')) {
    const std::optional<int> whole = take_number(rest, 2);
    if (!whole || *whole > 60) return std::nullopt;
    seconds = *whole;
    if (!rest.empty() && (rest[0] == '.' || rest[0] == ',' || rest[0] == ':')) {
      rest.remove_prefix(1);
      std::string digits = "0.";
      while (!rest.empty() && is_digit(rest[0])) {
        digits += rest[0];
        rest.remove_prefix(1);
        ++clock.decimals;
      }
      if (clock.decimals == 0) return std::nullopt;
      fraction = std::strtod(digits.c_str(), nullptr);
    }
  }
  clock.has_time = true;
  int hour = *hours;
  rest = firmware::trimmed(rest);
  if (rest.size() >= 2 && (equal_lower(rest.substr(0, 2), "am") || equal_lower(rest.substr(0, 2), "pm"))) {
    if (hour > 12) return std::nullopt;
    hour = hour % 12 + (equal_lower(rest.substr(0, 2), "pm") ? 12 : 0);
    rest = firmware::trimmed(rest.substr(2));
  }
  // A zone moves all stamps alike.
  const bool zone =
      rest.empty() || rest == "Z" || rest == "UTC" || ((rest[0] == '+' || rest[0] == '-') && rest.size() <= 6);
  if (!zone) return std::nullopt;
  clock.seconds = 3600.0 * hour + 60.0 * *minutes + seconds + fraction;
  return clock;
}

}  // namespace host_sim
