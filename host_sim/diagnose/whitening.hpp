// Residuals in units of their uncertainty.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/response.hpp"

namespace host_sim::diagnose {

/// Turns the difference between measured and simulated channels over one window of one recording into numbers that are
/// independent with variance 1 as long as nothing but known noise is in them.
///
///   (1)  R_c(f) = Σ_k w_k (measured − simulated)_k e^{−2πi fk},  tapered w, f up to `highest`
///   (2)  Σ(f) = diag(σ_c²) + N(f) + ε² diag(S_c(f))
///   (3)  whitened = √(2/Σw²) Σ(f)^{−½} R(f)                        Σ^{−½}: inverse Cholesky factor
///
/// N: what the noise of a measured input makes of the channels, one matrix for all of them because it comes from one
/// source (carried_noise.hpp); S_c: spectrum of the channel; ε: what the simulation itself is off.
class Whitening {
 public:
  static constexpr double band = 1.0;      ///< [Hz], in which Σ is taken to be one matrix
  static constexpr double highest = 90.0;  ///< [Hz]
  static constexpr double simulation_error = 2e-4;

  Whitening(const Evidence& evidence, Window window, const std::vector<Eigen::MatrixXcd>& input_noise = {});

  [[nodiscard]] std::size_t count() const { return 2 * bins_ * channels_; }
  [[nodiscard]] std::size_t bins() const { return bins_; }
  [[nodiscard]] double frequency(std::size_t bin) const;

  /// (3) appended to `out`: for each bin, for each channel, real and imaginary part.
  void operator()(const Evidence& evidence, const Response& response, std::vector<double>& out) const;

  /// The same with each channel by itself, in units of its own uncertainty: independent only within a channel.
  void by_channel(const Evidence& evidence, const Response& response, std::vector<double>& out) const;

  [[nodiscard]] const Window& window() const { return window_; }

 private:
  [[nodiscard]] std::vector<std::vector<std::complex<double>>> spectra(const Evidence& evidence,
                                                                       const Response* response) const;

  Window window_;
  std::size_t length_ = 0, bins_ = 0, channels_ = 0;
  double period_ = 0.0, scale_ = 0.0;
  std::vector<double> taper_;
  [[nodiscard]] std::size_t band_of(std::size_t bin) const;

  std::vector<Eigen::MatrixXcd> factors_;    // Σ^{−½} by band
  std::vector<Eigen::VectorXd> deviations_;  // √Σ_cc by band
};

}  // namespace host_sim::diagnose
