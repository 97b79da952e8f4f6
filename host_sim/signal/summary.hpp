// A signal in three numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace host_sim {

struct SignalSummary {
  double rms, lowest, highest;  ///< in the signal's unit
};

/// √(Σ x²/n), least and greatest value of at least one sample.
[[nodiscard]] inline SignalSummary summarise(std::span<const double> signal) {
  double squares = 0.0;
  for (const double value : signal) squares += value * value;
  const auto [low, high] = std::minmax_element(signal.begin(), signal.end());
  return {std::sqrt(squares / static_cast<double>(signal.size())), *low, *high};
}

/// max |x|; 0 of no sample.
[[nodiscard]] inline double largest_magnitude(std::span<const double> signal) {
  double largest = 0.0;
  for (const double value : signal) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace host_sim
