// A recorder's low-pass and its inverse, over the samples of a channel.
#pragma once

#include <complex>
#include <vector>

namespace host_sim::identification {

/// A Butterworth low-pass of order 1 … 4, with T the sample period:
///
///   (1)  H(f) = butterworth(order, x)                        common/butterworth.hpp
///   (2)  x = f/corner                                        analogue: before the converter
///          = tan(πfT)/tan(π corner T)                        digital: computed from the samples, bilinear
struct LowPass {
  double corner = 0.0;  ///< [Hz]
  int order = 1;
  bool digital = false;

  [[nodiscard]] std::complex<double> response(double f, double period) const;  ///< (1)
};

/// Samples behind the low-pass, from the steady state of the first sample on. Digital: exactly; analogue: exactly for
/// an input on the polynomial through six samples, which of 90 Hz at 1 kHz is wrong by 2e-4. An analogue corner beyond
/// three times the sample rate changes nothing. `period` [s].
[[nodiscard]] std::vector<double> low_passed(const LowPass& filter, const std::vector<double>& values, double period);

/// Samples as they were before the low-pass: a filter of 21 samples whose weights are a least-squares fit to 1/H up to
/// 0.16/T, relative to |1/H|. At 90 Hz and 1 kHz it is wrong by 1e-3 at most for corners from 60 Hz; beyond 0.16/T it
/// is no inverse, but stays bounded.
[[nodiscard]] std::vector<double> un_low_passed(const LowPass& filter, const std::vector<double>& values,
                                                double period);

}  // namespace host_sim::identification
