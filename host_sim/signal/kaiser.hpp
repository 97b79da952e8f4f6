// The window of the low-passes of finite length: decimation, interpolation, smoothing.
#pragma once

#include <cmath>

namespace host_sim {

inline constexpr double kaiser_attenuation = 100.0;  ///< [dB]: 1e-5 of the amplitude

/// Kaiser's window for kaiser_attenuation, |x| < 1:
///
///   (1)  w(x) = I₀(β √(1 − x²)) / I₀(β),    β = 0.1102 (A − 8.7)
///
/// An ideal low-pass times this window passes from all to nothing within (A − 7.95)/(14.36 · 2n) of the sample rate, n:
/// samples on either side. Source: A. V. Oppenheim, R. W. Schafer, Discrete-Time Signal Processing, 1999, ch. 7.3.
[[nodiscard]] inline double kaiser_window(double x) {
  constexpr double beta = 0.1102 * (kaiser_attenuation - 8.7);
  static const double middle = std::cyl_bessel_i(0.0, beta);
  return std::abs(x) < 1.0 ? std::cyl_bessel_i(0.0, beta * std::sqrt(1.0 - x * x)) / middle : 0.0;
}

/// n for a transition of this width, of the sample rate.
[[nodiscard]] inline double kaiser_length(double width) { return (kaiser_attenuation - 7.95) / (14.36 * width) / 2.0; }

}  // namespace host_sim
