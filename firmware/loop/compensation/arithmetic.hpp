// What the compensators compute with besides + − × ÷.
#pragma once

namespace firmware::compensation {

inline constexpr double turn = 6.283185307179586;  ///< 2π

[[nodiscard]] constexpr double magnitude(double value) { return value < 0.0 ? -value : value; }

[[nodiscard]] constexpr double limited(double value, double lowest, double highest) {
  return value < lowest ? lowest : value > highest ? highest : value;
}

}  // namespace firmware::compensation
