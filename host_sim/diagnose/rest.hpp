// What is left over, and where.
#pragma once

#include <string>
#include <vector>

#include "host_sim/diagnose/fit.hpp"
#include "host_sim/diagnose/noise_bands.hpp"

namespace host_sim::diagnose {

/// Standard deviations by which power must be above noise to count.
inline constexpr double significant = 8.0;
/// And by what share of the noise: no simulation's own error reaches that.
inline constexpr double loud_share = 0.15;

/// A channel's power beyond its noise in the fitted windows, in units of its noise.
struct ChannelExcess {
  model::Channel channel;
  double excess;           ///< Σ (χ² − n) over the bands where it is positive
  double significance;     ///< of the strongest band [standard deviations]
  double lowest, highest;  ///< band that holds the middle 80 % of it [Hz]
};
[[nodiscard]] std::vector<ChannelExcess> channel_excesses(const std::vector<BandPower>& powers);

/// By channel and band, of the fitted windows; bands without a residual are left out.
[[nodiscard]] std::vector<BandPower> band_powers(const Case& all, const Hypothesis& hypothesis);

/// Whether something is left that is not noise: in one channel and band, on fitted and on held-out data.
struct Rest {
  bool significant = false;
  double strongest = 0.0;  ///< [standard deviations]
  std::string words;       ///< channel, band
};
[[nodiscard]] Rest rest_of(const Case& all, const Hypothesis& hypothesis);

}  // namespace host_sim::diagnose
