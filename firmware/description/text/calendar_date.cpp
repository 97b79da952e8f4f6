#include "firmware/description/text/calendar_date.hpp"

#include <charconv>
#include <chrono>
#include <cstdio>

namespace firmware {
namespace {

/// Digits only: no sign, no blank.
std::optional<int> whole_of(std::string_view digits) {
  for (const char c : digits) {
    if (c < '0' || c > '9') return std::nullopt;
  }
  int value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

bool exists(const CalendarDate& date) {
  const std::chrono::year_month_day day{std::chrono::year(date.year),
                                        std::chrono::month(static_cast<unsigned>(date.month)),
                                        std::chrono::day(static_cast<unsigned>(date.day))};
  return day.ok() && date.year >= 1900 && date.year <= 2999;
}

}  // namespace

std::optional<CalendarDate> find_date(std::string_view text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  const auto year = whole_of(text.substr(0, 4)), month = whole_of(text.substr(5, 2)), day = whole_of(text.substr(8, 2));
  if (!year || !month || !day) return std::nullopt;
  const CalendarDate date{*year, *month, *day};
  return exists(date) ? std::optional(date) : std::nullopt;
}

std::string date_text(const CalendarDate& date) {
  char text[40];
  std::snprintf(text, sizeof text, "%04d-%02d-%02d", date.year, date.month, date.day);
  return text;
}

CalendarDate today() {
  const auto days = std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
  const std::chrono::year_month_day day{days};
  return {static_cast<int>(day.year()), static_cast<int>(static_cast<unsigned>(day.month())),
          static_cast<int>(static_cast<unsigned>(day.day()))};
}

}  // namespace firmware
