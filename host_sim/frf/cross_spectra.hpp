// Auto and cross spectra of several channels over several recordings, by averaged blocks.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "host_sim/signal/spectrum.hpp"

namespace host_sim::frf {

using Complex = std::complex<double>;

/// Division of recordings into blocks.
struct BlockScheme {
  std::size_t length = 0;  ///< N [samples], even
  std::size_t hop = 0;     ///< samples from the start of a block to that of the next, 1 … N
  WindowShape window = WindowShape::hann;
  Detrend detrend = Detrend::mean;

  /// Blocks in `samples` samples.
  [[nodiscard]] std::size_t blocks(std::size_t samples) const {
    return samples < length ? 0 : (samples - length) / hop + 1;
  }
};

/// A channel of one recording; its blocks are taken `shift` samples later than those of a channel with shift 0.
struct ShiftedSignal {
  std::span<const double> samples;
  std::ptrdiff_t shift = 0;
};

/// Welch's spectra of C channels, of which the first R are references:
///
///   (1)  S_ij(f_k) = c_k / (f_s Σ w²) · ⟨X_i* X_j⟩,   c_k = 2, but 1 at k = 0 and k = N/2
///
/// the mean over all blocks of all recordings; X_i is the transform of a block of channel i, with its trend removed and
/// weighted with w. S_xy is the cross spectrum of response y and input x, with phase −ωτ if y is x delayed by τ.
/// Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967), 70–73; the definition is that of scipy.signal.csd.
///
/// Each block of each channel is transformed once. Overlapping blocks count as fewer averages (welch_standard_error);
/// blocks of different recordings are independent.
class CrossSpectra {
 public:
  CrossSpectra(double sample_rate, const BlockScheme& scheme, std::size_t channels, std::size_t references);

  /// Adds all blocks that lie inside all channels of a recording: one signal per channel, all of one length. Returns
  /// the number of blocks.
  std::size_t add(std::span<const ShiftedSignal> recording);

  [[nodiscard]] std::size_t lines() const { return transform_.bins(); }     ///< N/2 + 1
  [[nodiscard]] std::size_t averages() const { return blocks_; }            ///< K
  [[nodiscard]] double effective_averages() const;                          ///< K independent ones
  [[nodiscard]] double frequency(std::size_t line) const;                   ///< [Hz]
  [[nodiscard]] double power(std::size_t channel, std::size_t line) const;  ///< S_ii [unit²/Hz]
  [[nodiscard]] Complex cross(std::size_t reference, std::size_t channel, std::size_t line) const;  ///< S_ij, i < R

 private:
  [[nodiscard]] double scale(std::size_t line) const;

  double sample_rate_;
  BlockScheme scheme_;
  std::size_t channels_, references_;
  BlockTransform transform_;
  std::vector<std::vector<Complex>> block_;  // transforms of the present block, by channel
  std::vector<std::vector<double>> power_;   // sums over blocks
  std::vector<std::vector<Complex>> cross_;  // by reference · channels + channel
  std::size_t blocks_ = 0;
  double squares_ = 0.0;  // Σ over recordings of (K_r ε_r)²: the sums' variance over their mean squared
};

}  // namespace host_sim::frf
