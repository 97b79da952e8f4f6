// The frequency response between two columns of a simulated run.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace host_sim::paper {

/// H₁ by Welch's method: both signals in segments that overlap by half, Hann window, means removed,
///
///   (1)  H(f) = ⟨X* Y⟩ / ⟨|X|²⟩          (2)  γ² = |⟨X* Y⟩|² / (⟨|X|²⟩ ⟨|Y|²⟩)
///
/// Noise of the output averages out; nonlinearity shows as coherence γ² below one.
struct TransferEstimate {
  std::vector<double> frequency;  ///< [Hz], about equal ratios
  std::vector<std::complex<double>> response;
  std::vector<double> coherence;
  std::size_t averages = 0;
};

/// \param segment  samples per segment; the frequency lines are f_s/segment apart
/// \param count    number of lines that are kept between `from` and `to` [Hz]
[[nodiscard]] TransferEstimate transfer_estimate(std::span<const double> input, std::span<const double> output,
                                                 double sample_rate, std::size_t segment, double from, double to,
                                                 std::size_t count);

/// Rate at which a decaying or growing oscillation changes [1/s]: slope of the logarithm of its rms in windows of
/// `window` samples, least squares.
[[nodiscard]] double growth_rate(std::span<const double> signal, double sample_rate, std::size_t window);

}  // namespace host_sim::paper
