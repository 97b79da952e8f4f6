// Fourier transforms, windows and power spectral densities of recordings.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <vector>

namespace host_sim {

inline constexpr double full_turn = 2.0 * std::numbers::pi;  ///< [rad]: ω = full_turn · f

/// The smallest even number ≥ n with no prime factor but 2, 3 and 5: a transform of that length is fast. At least 2.
[[nodiscard]] std::size_t good_fft_size(std::size_t n);

/// The largest such number ≤ n; n at least 2.
[[nodiscard]] std::size_t good_fft_size_at_most(std::size_t n);

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

  /// The N real numbers with these bins 0 … N/2, by another forward transform:
  ///
  ///   (2)  x_n = (1/N) Σ_k H_k cas(2πkn/N),   H = Re X − Im X,   cas = cos + sin
  ///
  /// Source: R. N. Bracewell, J. Opt. Soc. Am. 73 (1983), 1832–1835.
  [[nodiscard]] std::vector<double> inverse(std::span<const std::complex<double>> bins);

 private:
  struct Plan;
  std::size_t length_;
  std::unique_ptr<Plan> plan_;
  std::vector<double> input_;
  std::vector<std::complex<double>> output_;
};

/// A one-sided power spectral density by Welch's method: the signal is cut into segments of N samples that overlap by
/// half, each with its mean removed, weighted with a Hann window w and transformed; the periodograms are averaged:
///
///   (3)  S_k = c_k / (f_s Σ w²) · ⟨|X_k|²⟩,   c_k = 2, but 1 at k = 0 and k = N/2
///
/// so that Σ S_k f_s/N is the signal's variance. Neighbouring segments share samples, so K segments are worth fewer
/// independent averages. For Gaussian noise with a spectrum that is smooth over a few bins the relative standard error
/// of each S_k is
///
///   (4)  ε = √( (1 + 2 Σ_{j=1}^{K−1} (1 − j/K) ρ_j) / K ),   ρ_j = (Σ_n w_n w_{n+jN/2} / Σ w²)²
///
/// Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967), 70–73. A sine's line is 1.5 bins wide (Hann).
struct PowerSpectrum {
  std::vector<double> frequency;         ///< k f_s/N [Hz]
  std::vector<double> density;           ///< S_k [unit²/Hz]
  std::size_t averages = 0;              ///< K
  double relative_standard_error = 0.0;  ///< ε; at k = 0 and k = N/2 it is √2 times as large
};

/// The windows of a block of N samples, periodic: w_n is a function of n/N, and w_N would be w_0 again.
///
///   hann         ½ − ½ cos(2πn/N)
///   hamming      0.54 − 0.46 cos(2πn/N)
///   blackman     0.42 − 0.5 cos(2πn/N) + 0.08 cos(4πn/N)
///   rectangular  1
///
/// Source: F. J. Harris, Proc. IEEE 66 (1978), 51–83.
enum class WindowShape : unsigned char { hann, hamming, blackman, rectangular };
[[nodiscard]] std::vector<double> make_window(WindowShape shape, std::size_t length);
inline constexpr std::array<std::string_view, 4> window_names{"hann", "hamming", "blackman", "rectangular"};
[[nodiscard]] constexpr std::string_view name(WindowShape shape) {
  return window_names[static_cast<std::size_t>(shape)];
}

/// The Hann window: windows that overlap by half add up to one.
[[nodiscard]] std::vector<double> hann_window(std::size_t length);

/// Removed from each block before it is weighted: nothing, its mean, or its least-squares line.
enum class Detrend : unsigned char { none, mean, line };
inline constexpr std::array<std::string_view, 3> detrend_names{"none", "mean", "line"};
[[nodiscard]] constexpr std::string_view name(Detrend detrend) {
  return detrend_names[static_cast<std::size_t>(detrend)];
}

/// The transform (1) of a signal's blocks, each with its trend removed and weighted with the window. Not for use by
/// several threads at once.
class BlockTransform {
 public:
  BlockTransform(std::vector<double> window, Detrend detrend);  ///< of even length, as RealTransform

  [[nodiscard]] const std::vector<double>& window() const { return window_; }
  [[nodiscard]] double window_power() const { return power_; }  ///< Σ w²
  [[nodiscard]] std::size_t length() const { return transform_.length(); }
  [[nodiscard]] std::size_t bins() const { return transform_.bins(); }

  /// Of a block of length() samples; valid until the next call.
  [[nodiscard]] std::span<const std::complex<double>> operator()(std::span<const double> block);

 private:
  std::vector<double> window_;
  double power_;
  Detrend detrend_;
  RealTransform transform_;
  std::vector<double> block_;
};

/// (3), (4) with segments of good_fft_size(segment) samples, at most the signal's length (made even). A signal of fewer
/// than 4 samples or a rate that is not positive throws std::invalid_argument.
[[nodiscard]] PowerSpectrum welch(std::span<const double> signal, double sample_rate, std::size_t segment);

/// ε of (4) for K segments that start `hop` samples apart.
[[nodiscard]] double welch_standard_error(std::span<const double> window, std::size_t hop, std::size_t averages);

}  // namespace host_sim
