// Points in time and spans of time.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace hal {

/// A point in time since the clock's own origin, or a span between two points, in integer nanoseconds.
///
/// Integers, because a sum of a million periods must still be exact: 64 bit hold 292 years.
struct Time {
  std::int64_t ns = 0;

  friend constexpr bool operator==(Time, Time) = default;
  friend constexpr auto operator<=>(Time a, Time b) { return a.ns <=> b.ns; }
  friend constexpr Time operator+(Time a, Time b) { return {a.ns + b.ns}; }
  friend constexpr Time operator-(Time a, Time b) { return {a.ns - b.ns}; }
  friend constexpr Time operator*(Time a, std::int64_t n) { return {a.ns * n}; }
  constexpr Time& operator+=(Time other) {
    ns += other.ns;
    return *this;
  }

  /// The same span as a number [s]; correctly rounded, hence 1 000 000 ns is the double nearest to 0.001.
  [[nodiscard]] constexpr double seconds() const { return static_cast<double>(ns) / 1e9; }
};

/// The stamp of what has not happened.
inline constexpr Time never{std::numeric_limits<std::int64_t>::min()};

[[nodiscard]] constexpr Time nanoseconds(std::int64_t n) { return {n}; }
[[nodiscard]] constexpr Time microseconds(std::int64_t n) { return {n * 1'000}; }
[[nodiscard]] constexpr Time milliseconds(std::int64_t n) { return {n * 1'000'000}; }

/// The span of so many seconds, to the nearest nanosecond; |s| below 9e9.
[[nodiscard]] constexpr Time seconds(double s) {
  const double ns = s * 1e9;
  return {static_cast<std::int64_t>(ns < 0.0 ? ns - 0.5 : ns + 0.5)};
}

}  // namespace hal
