// How long the blocks of a recording should be, and how much they should overlap.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "host_sim/frf/cross_spectra.hpp"

namespace host_sim::frf {

/// The sharpest peak that is wanted, and what the user fixes himself.
struct BlockWish {
  double lowest_damping = 0.2;    ///< ζ of the mode; the defaults are those of a car body
  double lowest_frequency = 1.2;  ///< f [Hz] of the mode
  std::optional<double> block;    ///< T [s], rounded up to a length whose transform is fast
  std::optional<double> overlap;  ///< 0 … 0.95
  WindowShape window = WindowShape::hann;
  Detrend detrend = Detrend::mean;

  /// B = 2 ζ f [Hz]: how wide the peak is at half its power.
  [[nodiscard]] double bandwidth() const { return 2.0 * lowest_damping * lowest_frequency; }
};

/// What was chosen and what is to be expected of it.
struct BlockChoice {
  BlockScheme scheme;
  double peak_bias = 0.0;     ///< the share by which the peak comes out too low, (1)
  double random_error = 0.0;  ///< standard error of its magnitude, relative, (2)
};

/// Blocks of T cut the impulse response off: it is multiplied by the window's autocorrelation r(τ/T) (delay.hpp). At
/// the peak of a mode of half-power bandwidth B, whose response decays with a = πBT per block,
///
///   (1)  b = 1 − a ∫₀¹ e^{−au} r(u) du        Hann, BT ≫ 1: (4/3)/(BT)²
///
[[nodiscard]] double peak_bias(WindowShape window, double bandwidth_times_block);

/// Of K independent averages, with coherence γ² (Bendat and Piersol, table 9.6):
///
///   (2)  ε = √((1 − γ²)/(2 γ² K))
///
[[nodiscard]] double random_error(double averages, double coherence);

/// The coherence that the choice counts on.
inline constexpr double expected_coherence = 0.9;

/// The fewest samples in a block, and the fewest blocks that a choice leaves.
inline constexpr std::size_t shortest_block = 16;
inline constexpr std::size_t fewest_blocks = 5;

/// The block length for which b² + ε² is least, among those that leave five blocks that overlap by half, and no longer
/// than any recording. Overlap, unless given: of a rectangular window 0; else half, or three quarters where half
/// leaves fewer than 16 independent averages (which gains a tenth more of them, for twice the work).
///
/// \param recordings  their lengths [samples]
/// nullopt: not even a block of 1/B fits, or not two blocks end to end of the length that the user gave.
[[nodiscard]] std::optional<BlockChoice> choose_blocks(std::span<const std::size_t> recordings, double sample_rate,
                                                       const BlockWish& wish);

/// How long recordings have to be together for choose_blocks to succeed [s].
[[nodiscard]] double needed_duration(const BlockWish& wish, double sample_rate);

}  // namespace host_sim::frf
