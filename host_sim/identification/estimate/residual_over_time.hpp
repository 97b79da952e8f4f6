// The residual of a fit by channel, band and stretch of time, and the test whether it is more than noise.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/estimate/prediction.hpp"

namespace host_sim::identification {

/// Σ r² of the whitened residuals of one stretch of a recording, by channel and band. The stretch is whitened by
/// itself, with a taper at both ends.
///
///   (1)  variance of Σ r² over n residuals of noise = 2n · spread,   spread = N Σw⁴/(Σw²)²,   w: taper of N samples
struct StretchPower {
  std::size_t recording;
  bool held_out;
  double from, to;                                     ///< [s], as in the recording
  std::vector<std::array<Power, noise_bands>> powers;  ///< of each channel by itself
  std::array<Power, noise_bands> together;             ///< of all: freed from what noise of the input they share
  double spread;

  [[nodiscard]] Power of_channel(std::size_t channel) const;  ///< all bands
};

/// Fitted and held-out windows, cut into equal parts of about so many seconds. `responses`: read_all() of a hypothesis.
[[nodiscard]] std::vector<StretchPower> stretch_powers(const IdentificationProblem& problem,
                                                       const std::vector<Response>& responses, double seconds);

/// The length of a stretch for a reader: a second, or as much more as thresholds::most_seconds_shown asks for.
[[nodiscard]] double shown_stretch(const IdentificationProblem& problem);

/// A rest: residuals that are more than noise, in the part of the record where that is surest.
///
/// Every channel, and all together, is tested over the whole record (fitted and held out) and over each of
/// thresholds::stretches of it, in every band and over all bands. With M such tests each may be wrong once in
/// M/family_error cases, so that a recording of noise alone is flagged once in 1/family_error.
///
///   (2)  z = ((Σr²/n)^⅓ − 1 + 2/(9m)) / √(2/(9m)),   m = n/spread        Wilson and Hilferty, PNAS 17, 1931
///   (3)  z_level = z / √(1 + δ² m/2)
///
/// (3): δ is how well the variance of the channel's noise is known; an error of it shifts all of its tests alike. Where
/// corners are blurred (unexplained_residual.hpp) it is thresholds::corner_power_error.
struct Rest {
  double z = 0.0;          ///< (3) of the surest test [standard deviations]; 0: none was made
  double threshold = 0.0;  ///< z of a rest
  double ratio = 1.0;      ///< Σr²/n there
  bool all_channels = false;
  model::Channel channel{};
  double lowest = 0.0, highest = 0.0;  ///< band [Hz]
  bool all_time = true;
  std::size_t recording = 0;
  double from = 0.0, to = 0.0;  ///< [s]
  bool is_fitted = false;       ///< what is fitted leaves a rest by itself

  [[nodiscard]] bool found() const { return z > threshold; }
  [[nodiscard]] std::string words() const;  ///< channel, band, stretch, power
};
/// `responses`: read_all() of the hypothesis.
[[nodiscard]] Rest find_rest(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                             const std::vector<Response>& responses);

}  // namespace host_sim::identification
