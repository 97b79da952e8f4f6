// Residuals of one recording in units of their standard deviation, frequency by frequency.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tests/reference/prediction.hpp"

namespace reference {

/// The residual of the channels at a frequency has the covariance
///
///   (7)  Σ(f) = diag(σ_c² h_c(f) + ε² S_c) + ⟨D Dᴴ⟩/Σw²          ε = hypot(2·10⁻⁴, (ωh)⁴/30)
///
/// σ_c: declared noise, h_c = 1, of a held channel P/h sinc²(fP); S_c: power of the channel in the band, ε: error of the
/// simulation; D: what noise of z_r of the declared size, drawn a few times, changes in the prediction of `model`, mean
/// over 1 Hz. So what is coherent with that noise counts, and instants of friction that it moves. Whitened is
///
///   (8)  r(f) = L⁻¹ √(2/Σw²) Σ_k w_k (measured − predicted)_k e^{−2πi fk},   Σ = L Lᴴ
///
/// real and imaginary part of each channel, up to 90 Hz. w: a cosine taper of 0.25 s at each end, 0 at clipped samples.
class Whitening {
 public:
  Whitening(const firmware::RigDescription& description, const Measured& measured, const Model& model);

  [[nodiscard]] Eigen::VectorXd operator()(const Measured& measured, const host_sim::Response& predicted) const;
  /// Of each residual: channel · bands + band.
  [[nodiscard]] const std::vector<std::size_t>& cells() const { return cells_; }

 private:
  using Spectra = Eigen::MatrixXcd;  ///< channel × bin
  [[nodiscard]] Spectra spectra(const Measured& measured, const host_sim::Response& of, const host_sim::Response& less) const;

  std::size_t length_, bins_;
  std::vector<std::vector<double>> weights_;  ///< by channel
  std::vector<Eigen::MatrixXcd> factors_;     ///< √(2/Σw²) L⁻¹ by hertz
  double resolution_;                         ///< [Hz] of bins
  std::vector<std::size_t> cells_;
};

}  // namespace reference
