// The bands in which residuals are compared with noise.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace host_sim::identification {

/// Edges [Hz]: narrow where modes are, wide enough above for many independent bins.
inline constexpr std::array<double, 14> noise_band_edges{0.0, 0.5,  1.0,  2.0,  3.0,  4.5,  6.5,
                                                         9.0, 13.0, 18.0, 26.0, 40.0, 60.0, 90.0};
inline constexpr std::size_t noise_bands = noise_band_edges.size() - 1;

/// The band that holds f [Hz]; noise_bands beyond the last.
[[nodiscard]] constexpr std::size_t noise_band_of(double f) {
  const auto* const above = std::upper_bound(noise_band_edges.begin(), noise_band_edges.end(), f);
  return above == noise_band_edges.end() ? noise_bands : static_cast<std::size_t>(above - noise_band_edges.begin()) - 1;
}

/// Power of whitened residuals: as much as there are of them where nothing but noise is in them.
struct Power {
  double squares = 0.0, count = 0.0;  ///< Σ r², how many

  [[nodiscard]] double ratio() const { return squares / count; }
  [[nodiscard]] double excess() const { return squares - count; }
  /// Of the excess [standard deviations].
  [[nodiscard]] double significance() const { return count > 0.0 ? excess() / std::sqrt(2.0 * count) : 0.0; }
};

}  // namespace host_sim::identification
