// The frequency response of a Butterworth low-pass.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

namespace host_sim::identification {

/// Damping d_m of the m-th of order/2 pairs of poles: d_m = 2 sin(π (2m + 1)/(2 order)).
[[nodiscard]] inline double butterworth_damping(int order, int m) {
  return 2.0 * std::sin(std::numbers::pi * (2.0 * m + 1.0) / (2.0 * order));
}

/// 1 / Π_m (1 + d_m s + s²) / (1 + s), s = i x; the last factor where the order is odd. x: frequency ÷ corner.
[[nodiscard]] inline std::complex<double> butterworth(int order, double x) {
  std::complex<double> product = order % 2 == 1 ? std::complex(1.0, x) : 1.0;
  for (int m = 0; m < order / 2; ++m) product *= std::complex(1.0 - x * x, butterworth_damping(order, m) * x);
  return 1.0 / product;
}

/// −dφ/dx of it at 0: its delay there is that ÷ (2π corner).
[[nodiscard]] inline double butterworth_delay(int order) {
  double sum = order % 2 == 1 ? 1.0 : 0.0;
  for (int m = 0; m < order / 2; ++m) sum += butterworth_damping(order, m);
  return sum;
}

}  // namespace host_sim::identification
