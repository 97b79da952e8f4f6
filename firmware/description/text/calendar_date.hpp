// Dates of the calendar, as certificates and command lines have them.
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <string_view>

namespace firmware {

/// A day of the Gregorian calendar.
struct CalendarDate {
  int year = 0, month = 0, day = 0;

  friend auto operator<=>(const CalendarDate&, const CalendarDate&) = default;  // NOLINT(modernize-use-nullptr)
};

/// "2026-03-01" (ISO 8601, extended format) of the years 1900 … 2999; nothing for any other text or for a day that no
/// month has.
[[nodiscard]] std::optional<CalendarDate> find_date(std::string_view text);
[[nodiscard]] std::string date_text(const CalendarDate& date);

/// Today in universal time (UTC).
[[nodiscard]] CalendarDate today();

}  // namespace firmware
