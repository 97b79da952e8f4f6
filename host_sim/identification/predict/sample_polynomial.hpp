// Values between samples: the polynomial of fifth order through the six samples around a place.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace host_sim::identification {

inline constexpr std::ptrdiff_t polynomial_points = 6;
using SampleWeights = std::array<double, polynomial_points>;

/// Lagrange's weights of the samples 0 … 5 for N places between them, by sample and place.
template <std::size_t N>
[[nodiscard]] inline std::array<std::array<double, N>, polynomial_points> weights_at_each(
    const std::array<double, N>& places) {
  constexpr SampleWeights shares{-1.0 / 120.0, 1.0 / 24.0, -1.0 / 12.0, 1.0 / 12.0, -1.0 / 24.0, 1.0 / 120.0};
  std::array<std::array<double, N>, polynomial_points> weights;
  std::array<double, N> before, behind;
  before.fill(1.0);
  behind.fill(1.0);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    for (std::size_t j = 0; j < N; ++j) weights[i][j] = shares[i] * before[j];
    for (std::size_t j = 0; j < N; ++j) before[j] *= places[j] - static_cast<double>(i);
  }
  for (std::size_t i = shares.size(); i-- > 0;) {
    for (std::size_t j = 0; j < N; ++j) weights[i][j] *= behind[j];
    for (std::size_t j = 0; j < N; ++j) behind[j] *= places[j] - static_cast<double>(i);
  }
  return weights;
}

/// The same for one place x.
[[nodiscard]] inline SampleWeights weights_at(double x) {
  const auto each = weights_at_each<1>({x});
  SampleWeights weights{};
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = each[i].front();
  return weights;
}

/// The first of the six samples around a place; `count` of them in all, at least six.
[[nodiscard]] inline std::ptrdiff_t first_around(std::ptrdiff_t place, std::ptrdiff_t count) {
  return std::clamp<std::ptrdiff_t>(place - 2, 0, count - polynomial_points);
}

[[nodiscard]] inline double weighted(const SampleWeights& weights, const double* values) {
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * values[i];
  return sum;
}

/// The value at `place` [samples]; beyond the ends the first or last. Of a sine of ω = 0.57 rad per sample (90 Hz at 1
/// kHz) it is wrong by 2e-4 at most.
[[nodiscard]] inline double value_between(const std::vector<double>& values, double place) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  place = std::clamp(place, 0.0, static_cast<double>(count - 1));
  if (count < polynomial_points) return values[static_cast<std::size_t>(std::lround(place))];
  const std::ptrdiff_t first = first_around(static_cast<std::ptrdiff_t>(place), count);
  return weighted(weights_at(place - static_cast<double>(first)), values.data() + first);
}

}  // namespace host_sim::identification
