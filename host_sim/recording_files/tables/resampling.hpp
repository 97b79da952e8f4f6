// Samples of one time axis on another.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace host_sim {

/// The even grid that replaces uneven time stamps.
struct EvenGrid {
  std::vector<double> time;  ///< [s] without the instants inside gaps
  double period;             ///< [s]
  double shortest_step;      ///< [s] of the stamps outside gaps
  double longest_step;       ///< [s]
  std::size_t gaps;
};

/// nullopt: the stamps rise by even steps up to 10⁻³ of them (then nothing is to do), or they do not rise.
///
///   (1)  T = mean of the steps below 1.6 medians, or 1/rate where that is T ± 1 %
///   (2)  t_k = t₀ + k T, without those that lie in a step of more than 1.6 medians
[[nodiscard]] std::optional<EvenGrid> even_grid(const std::vector<double>& time, std::optional<double> rate);

/// Values at the instants of another axis; both rise. NaN beside NaN and inside gaps of the samples (steps of more than
/// 1.6 medians).
///
///   (3)  slower or equal:  linear between the two samples around the instant
///   (4)  faster by n ≥ 2:  mean of the samples within ± half a period of the axis, linearly weighted at its ends
struct Resampled {
  std::vector<double> values;
  std::string how;  ///< "100 Hz, interpolated linearly to 1000 Hz"; empty: the same rate
};
[[nodiscard]] Resampled resample(const std::vector<double>& time, const std::vector<double>& values,
                                 const std::vector<double>& axis);

}  // namespace host_sim
