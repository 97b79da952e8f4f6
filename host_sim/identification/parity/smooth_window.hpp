// Derivatives of noisy samples without differences: through a smooth window.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

namespace host_sim::identification {

/// A B-spline φ of degree 5, knots 5 ms apart or 5 samples, and its derivatives:
///
///   φ ∗ ẏ = φ′ ∗ y,   φ ∗ ÿ = φ″ ∗ y
///
/// so that a relation between signals and their derivatives holds between their convolutions. At the samples the sums
/// are the integrals up to what the spline leaves of frequencies near the sample rate: 1e-4 of a second derivative at
/// 25 Hz and 1 kHz.
class SmoothWindow {
 public:
  explicit SmoothWindow(double period);

  /// Samples to each side.
  [[nodiscard]] std::ptrdiff_t reach() const { return reach_; }
  /// The convolution of y with φ (order 0), φ′, φ″; 0 where the window does not fit.
  [[nodiscard]] std::vector<double> operator()(const std::vector<double>& y, int order) const;
  /// What it makes of e^{iωt}.
  [[nodiscard]] std::complex<double> gain(int order, double frequency) const;

 private:
  double period_;
  std::ptrdiff_t reach_;
  std::array<std::vector<double>, 3> taps_;
};

}  // namespace host_sim::identification
