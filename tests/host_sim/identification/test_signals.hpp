// Signals for tests of the diagnosis.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace sample {

/// `count` samples of amplitude · sin(2π hz k step); hz [Hz], step [s].
inline std::vector<double> sine(double amplitude, double hz, std::size_t count, double step = 1e-3) {
  std::vector<double> values(count);
  for (std::size_t k = 0; k < count; ++k) {
    values[k] = amplitude * std::sin(2.0 * std::numbers::pi * hz * step * static_cast<double>(k));
  }
  return values;
}

}  // namespace sample
