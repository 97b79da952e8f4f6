// Whitening: residuals in units of their standard deviation, frequency by frequency.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <vector>

#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/noise/decimation.hpp"
#include "host_sim/identification/noise/thresholds.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace host_sim::identification {

/// Of one channel, 0 Hz first.
using Spectrum = std::vector<std::complex<double>>;
using Spectra = std::vector<Spectrum>;  ///< by channel of the recording

/// Turns the difference between measured and simulated channels over one window of one recording into numbers that are
/// independent with variance 1 as long as they hold nothing but known noise.
///
///   (1)  R_c(f) = Σ_k w_k (measured − simulated)_k e^{−2πi fk},  w: taper, f up to thresholds::highest_frequency
///   (2)  Σ(f) = diag(σ_c² h_c(f)) + N(f) + ε² diag(S_c(f)) + ε_c² diag(rms_c²)
///        ε² = simulation_error² + ((2πf h)⁴/30)²,  h: step of the simulation, whose input has velocities by
///        differences of fourth order: at 90 Hz and 1 kHz 0.34 % of the channel
///   (3)  whitened = √(2/Σw²) L(f)⁻¹ R(f),   Σ = L Lᴴ (Cholesky)
///   (4)  h_c(f) = P sinc²(f P h) of a channel that is held for P samples, whose noise is held too; else
///   (5)  h_c(f): the colour of the channel's noise, prepare/noise_spectrum.hpp (1)
///   (6)  (1 − h_c)² S_c is added to Σ: the low-pass acts on the signal, too, and on what corners leave of it not as on
///        the input that drives the simulation. |1 − H|² of a Butterworth filter, less its delay, is of that order.
///        Of a filter that the hypothesis has (ChannelNoise::on_signal) only (thresholds::filter_error · (1 − h_c))²
///        S_c is added.
///
/// Where the mean of the input is unknown (PreparedRecording::mean_unknown) each channel is freed from its own, x̄ = Σ w
/// x / Σ w. Of an acceleration's mean one thing is known, since the mass stays near the road: it is the change of a
/// velocity over the window, of T seconds. So
///
///   (7)  x − (1 − s/√(s² + a²)) x̄,   s = σ_c √Σw² / Σw,   a = √(2 g) rms(ż of the input) / T
///
/// whose mean has the variance s², g: thresholds::integrated_noise_in_lowest_band, what a body mode makes of it. The
/// mean of an input that was an acceleration is a ramp of its velocity, and of what a damper of the guides makes of it:
///
///   (8)  each of these channels is freed from its line, too: slope = Σ w (k − k̄) x / Σ w (k − k̄)²
///
/// k counts the samples that were recorded, also where a simulation has more of them (PreparedRecording::step).
///
/// N: covariance of what the input's noise makes of the channels (input_noise_covariance.hpp); S_c: power of the
/// channel; ε: error of the simulation itself; ε_c: an allowed error of the model, alike at every frequency.
///
/// Σ |whitened|² is then −2 ln of the likelihood up to a constant. Source: P. Whittle, The analysis of multiple
/// stationary time series, J. R. Stat. Soc. B 15, 1953; L. Ljung, System Identification, 1999, ch. 7.
class Whitening {
 public:
  /// `noise`: of the channels. `input_noise`: N(f), a matrix for each thresholds::covariance_band; empty: none.
  /// `model_error`: ε_c.
  Whitening(const PreparedRecording& recording, Window window, const ChannelNoises& noise,
            const std::vector<Eigen::MatrixXcd>& input_noise = {}, double model_error = 0.0);

  [[nodiscard]] std::size_t count() const { return 2 * bins_ * channels_; }
  [[nodiscard]] std::size_t bins() const { return bins_; }
  [[nodiscard]] double frequency(std::size_t bin) const;

  /// Σ_k w_k values_k e^{−2πi fk} of the readings of one channel, of which this window is part.
  [[nodiscard]] Spectrum spectrum(const PreparedRecording& recording, std::size_t channel,
                                  const std::vector<double>& readings) const;
  [[nodiscard]] Spectra spectra(const PreparedRecording& recording, const Response& readings) const;

  /// (3) of simulated channels: for each bin, for each channel, real and imaginary part; count() numbers.
  void whiten(const Spectra& simulated, double* out) const;

  /// The same with each channel by itself, in units of its own deviation: independent only within a channel.
  [[nodiscard]] std::vector<double> by_channel(const Spectra& simulated) const;

  [[nodiscard]] const Window& window() const { return window_; }

  /// N Σw⁴/(Σw²)²: how much the taper makes Σ|whitened|² scatter more than as many independent numbers.
  [[nodiscard]] double spread() const;

 private:
  void set_taper();
  /// `share`: of the mean that is taken away.
  void remove_line(const std::vector<bool>& clipped, double share, std::vector<double>& tapered) const;
  void set_means_kept(const PreparedRecording& recording, const ChannelNoises& noise);
  [[nodiscard]] Eigen::MatrixXcd covariance(const PreparedRecording& recording, std::size_t band,
                                            const ChannelNoises& noise,
                                            const std::vector<Eigen::MatrixXcd>& input_noise, double model_error,
                                            const std::vector<double>& mean_squares) const;
  [[nodiscard]] double power(std::size_t channel, std::size_t band) const;
  [[nodiscard]] std::size_t band_of(std::size_t bin) const;

  Decimation decimation_;
  Window window_;
  std::size_t step_ = 1;  ///< samples for each one that is compared
  std::size_t length_ = 0, bins_ = 0, channels_ = 0;
  double period_ = 0.0;
  double taper_power_ = 0.0;  ///< Σ w²
  double scale_ = 0.0;        ///< √(2/Σ w²)
  std::vector<double> taper_;
  std::vector<double> means_kept_;  ///< 1 − share of (7) that is taken away, by channel
  Spectra data_;
  std::vector<Eigen::MatrixXcd> factors_;    ///< L⁻¹ by band
  std::vector<Eigen::VectorXd> deviations_;  ///< √Σ_cc by band
};

}  // namespace host_sim::identification
