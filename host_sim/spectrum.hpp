// Power spectral densities of recordings.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace host_sim {

/// The smallest even number ≥ n with no prime factor but 2, 3 and 5: a transform of that length is fast. At least 2.
[[nodiscard]] std::size_t good_fft_size(std::size_t n);

/// The discrete Fourier transform of real signals of one even length N, bins 0 … N/2:
///
///   (1)  X_k = Σ_n x_n e^{−2πi kn/N}
///
/// Not for use by several threads at once.
class RealTransform {
 public:
  explicit RealTransform(std::size_t length);  ///< even, ≥ 2; else throws std::invalid_argument
  ~RealTransform();
  RealTransform(const RealTransform&) = delete;
  RealTransform& operator=(const RealTransform&) = delete;

  [[nodiscard]] std::size_t length() const { return length_; }
  [[nodiscard]] std::size_t bins() const { return length_ / 2 + 1; }

  /// (1); the signal may be shorter than N: zeros follow it. The result is valid until the next call.
  [[nodiscard]] std::span<const std::complex<double>> operator()(std::span<const double> signal);

 private:
  struct Plan;
  std::size_t length_;
  std::unique_ptr<Plan> plan_;
  std::vector<double> input_;
  std::vector<std::complex<double>> output_;
};

/// A one-sided power spectral density by Welch's method: the signal is cut into segments of N samples that overlap by
/// half, each freed from its mean, weighted with a Hann window w and transformed; the periodograms are averaged:
///
///   (2)  S_k = c_k / (f_s Σ w²) · ⟨|X_k|²⟩,   c_k = 2, but 1 at k = 0 and k = N/2
///
/// so that Σ S_k f_s/N is the signal's variance. Because neighbouring segments share samples, K of them count for
/// fewer. For Gaussian noise with a spectrum that is smooth over a few bins the relative standard error of each S_k is
///
///   (3)  ε = √( (1 + 2 Σ_{j=1}^{K−1} (1 − j/K) ρ_j) / K ),   ρ_j = (Σ_n w_n w_{n+jN/2} / Σ w²)²
///
/// Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967), 70–73. A sine's line is 1.5 bins wide (Hann).
struct PowerSpectrum {
  std::vector<double> frequency;         ///< k f_s/N [Hz]
  std::vector<double> density;           ///< S_k [unit²/Hz]
  std::size_t averages = 0;              ///< K
  double relative_standard_error = 0.0;  ///< ε; at k = 0 and k = N/2 it is √2 times as large
};

/// (2), (3) with segments of good_fft_size(segment) samples, at most the signal's length (made even). A signal of fewer
/// than 4 samples or a rate that is not positive throws std::invalid_argument.
[[nodiscard]] PowerSpectrum welch(std::span<const double> signal, double sample_rate, std::size_t segment);

/// The Hann window w_n = ½ − ½ cos(2πn/N), periodic: what overlaps by half adds up to one.
[[nodiscard]] std::vector<double> hann_window(std::size_t length);

/// ε of (3) for K segments that start `hop` samples apart.
[[nodiscard]] double welch_standard_error(std::span<const double> window, std::size_t hop, std::size_t averages);

}  // namespace host_sim
