// Choice of block length and overlap.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "host_sim/frf/cross_spectra.hpp"

namespace host_sim::frf {

/// The sharpest peak to be resolved, and the values that the user sets.
struct BlockWish {
  double lowest_damping = 0.2;    ///< ζ of the mode; the defaults are those of a car body
  double lowest_frequency = 1.2;  ///< f [Hz] of the mode
  std::optional<double> block;    ///< T [s], rounded up to a length whose transform is fast
  std::optional<double> overlap;  ///< 0 … 0.95
  WindowShape window = WindowShape::hann;
  Detrend detrend = Detrend::mean;

  /// B = 2 ζ f [Hz]: half-power bandwidth of the peak.
  [[nodiscard]] double bandwidth() const { return 2.0 * lowest_damping * lowest_frequency; }
};

/// The choice and its expected errors.
struct BlockChoice {
  BlockScheme scheme;
  double peak_bias = 0.0;     ///< relative bias of the peak, too low by this share, (1)
  double random_error = 0.0;  ///< relative standard error of its magnitude, (2)
};

/// Blocks of length T truncate the impulse response: it is multiplied by the autocorrelation r(τ/T) of the window
/// (delay.hpp). For a mode of half-power bandwidth B, whose response decays with a = πBT per block, the peak is too low
/// by
///
///   (1)  b = 1 − a ∫₀¹ e^{−au} r(u) du        Hann, BT ≫ 1: (4/3)/(BT)²
///
[[nodiscard]] double peak_bias(WindowShape window, double bandwidth_times_block);

/// Random error of K independent averages at coherence γ² (Bendat and Piersol, Random Data, table 9.6):
///
///   (2)  ε = √((1 − γ²)/(2 γ² K))
///
[[nodiscard]] double random_error(double averages, double coherence);

/// Coherence assumed by the choice [1]: that of a good rig recording near a resonance. It weights the random error
/// against the bias. At half of it blocks would be 0.62 times as long (T ∝ ε₀^(−2/5)).
inline constexpr double expected_coherence = 0.9;

/// Smallest number of samples in a block, and smallest number of blocks in a choice. With fewer than five averages the
/// bounds are wider than the response.
inline constexpr std::size_t shortest_block = 16;
inline constexpr std::size_t fewest_blocks = 5;

/// The block length with the smallest b² + ε², among lengths that leave five blocks with half overlap and that fit into
/// every recording. Overlap, unless given: 0 for a rectangular window; else half, or three quarters if half leaves
/// fewer than 16 independent averages (gains a tenth more averages for twice the work).
///
/// \param recordings  lengths of the recordings [samples]
/// nullopt: a block of length 1/B does not fit, or two blocks of the given length do not fit end to end.
[[nodiscard]] std::optional<BlockChoice> choose_blocks(std::span<const std::size_t> recordings, double sample_rate,
                                                       const BlockWish& wish);

/// Total duration of recordings that choose_blocks needs [s].
[[nodiscard]] double needed_duration(const BlockWish& wish, double sample_rate);

}  // namespace host_sim::frf
