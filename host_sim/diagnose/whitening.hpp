// Residuals in units of their uncertainty.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "host_sim/diagnose/decimation.hpp"
#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/response.hpp"

namespace host_sim::diagnose {

/// Of one channel, 0 Hz first.
using Spectrum = std::vector<std::complex<double>>;
using Spectra = std::vector<Spectrum>;  ///< by channel of the evidence

/// Turns the difference between measured and simulated channels over one window of one recording into numbers that are
/// independent with variance 1 as long as nothing but known noise is in them.
///
///   (1)  R_c(f) = Σ_k w_k (measured − simulated)_k e^{−2πi fk},  tapered w, f up to `highest`
///   (2)  Σ(f) = diag(σ_c²) + N(f) + ε² diag(S_c(f)) + ε_c² diag(rms_c²)
///   (3)  whitened = √(2/Σw²) Σ(f)^{−½} R(f)                        Σ^{−½}: inverse Cholesky factor
///
/// A channel that repeats itself for P samples repeats its noise, too: σ² P sinc²(f P h) instead of σ².
///
/// N: what the noise of a measured input makes of the channels, one matrix for all of them because it comes from one
/// source (carried_noise.hpp); S_c: spectrum of the channel; ε: what the simulation itself is off, relative; ε_c: an
/// error of the model that is allowed for, relative to the rms of the channel, alike at every frequency.
class Whitening {
 public:
  static constexpr double band = 1.0;      ///< [Hz], in which Σ is taken to be one matrix
  static constexpr double highest = 90.0;  ///< [Hz]
  static constexpr double simulation_error = 2e-4;

  /// `model_error`: ε_c.
  Whitening(const Evidence& evidence, Window window, const std::vector<Eigen::MatrixXcd>& input_noise = {},
            double model_error = 0.0);

  [[nodiscard]] std::size_t count() const { return 2 * bins_ * channels_; }
  [[nodiscard]] std::size_t bins() const { return bins_; }
  [[nodiscard]] double frequency(std::size_t bin) const;

  /// Σ_k w_k values_k e^{−2πi fk} of the readings of one channel, of which this window is part.
  [[nodiscard]] Spectrum spectrum(const Evidence& evidence, std::size_t channel,
                                  const std::vector<double>& readings) const;
  [[nodiscard]] Spectra spectra(const Evidence& evidence, const Response& readings) const;

  /// (3) of simulated channels: for each bin, for each channel, real and imaginary part; count() numbers.
  void whiten(const Spectra& simulated, double* out) const;

  /// The same with each channel by itself, in units of its own uncertainty: independent only within a channel.
  [[nodiscard]] std::vector<double> by_channel(const Spectra& simulated) const;

  [[nodiscard]] const Window& window() const { return window_; }

 private:
  [[nodiscard]] std::size_t band_of(std::size_t bin) const;

  Decimation decimation_;
  Window window_;
  std::size_t length_ = 0, bins_ = 0, channels_ = 0;
  double period_ = 0.0, scale_ = 0.0;
  std::vector<double> taper_;
  Spectra data_;
  std::vector<Eigen::MatrixXcd> factors_;    // Σ^{−½} by band
  std::vector<Eigen::VectorXd> deviations_;  // √Σ_cc by band
};

}  // namespace host_sim::diagnose
