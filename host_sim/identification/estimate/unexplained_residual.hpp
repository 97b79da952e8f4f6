// What a fit leaves beyond noise, by channel and band.
#pragma once

#include <string>
#include <vector>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/estimate/prediction.hpp"

namespace host_sim::identification {

/// Power of whitened residuals of a channel in a band, with its 95 % bounds. Of n residuals of noise alone
///
///   (1)  ratio = Σ r²/n = 1 ± √(2/n)            significance = (Σ r² − n)/√(2n)
///   (2)  bounds: ratio · n/χ²_n(97.5 %) … ratio · n/χ²_n(2.5 %)
///
/// χ²_n by E. B. Wilson and M. M. Hilferty, The distribution of chi-square, PNAS 17, 1931.
struct BandPower {
  model::Channel channel;
  double lowest, highest;  ///< [Hz]
  Power power;
  double lower, upper;  ///< (2)
};
/// By channel and band, of the fitted windows; bands without a residual are left out.
[[nodiscard]] std::vector<BandPower> band_powers(const IdentificationProblem& problem, const Hypothesis& hypothesis);

/// A channel's power beyond its noise in the fitted windows, in units of its noise.
struct ChannelExcess {
  model::Channel channel;
  double excess;           ///< Σ (χ² − n) over the bands where it is positive
  double significance;     ///< of the strongest band [standard deviations]
  double lowest, highest;  ///< band that holds the middle 80 % of it [Hz]
};
[[nodiscard]] std::vector<ChannelExcess> channel_excesses(const std::vector<BandPower>& powers);

/// Noise of the input moves the instants of the model's corners: what that leaves comes in bursts, of a power that no
/// stationary covariance describes.
[[nodiscard]] bool corners_are_blurred(const IdentificationProblem& problem, const Hypothesis& hypothesis);

/// Whether something is left that is not noise: in one channel and band by thresholds::significant_deviations and
/// significant_share, on fitted and on held-out data. Where corners are blurred, corner_power_error takes the place of
/// that share. `responses`: read_all() of the hypothesis.
struct UnexplainedResidual {
  bool significant = false;
  double strongest = 0.0;  ///< [standard deviations]
  std::string words;       ///< channel, band; empty where nothing is left
};
[[nodiscard]] UnexplainedResidual unexplained_residual(const IdentificationProblem& problem,
                                                       const Hypothesis& hypothesis,
                                                       const std::vector<Response>& responses);
[[nodiscard]] inline UnexplainedResidual unexplained_residual(const IdentificationProblem& problem,
                                                              const Hypothesis& hypothesis) {
  return unexplained_residual(problem, hypothesis, read_all(problem, hypothesis));
}

/// Error of the fitted windows: √ of the mean over channels and recordings of Σ(simulated − measured)²/Σ measured².
[[nodiscard]] double pooled_error(const IdentificationProblem& problem, const Hypothesis& hypothesis);

/// Sums over a window of a channel, clipped samples left out.
struct SquaredError {
  double error = 0.0;  ///< Σ (simulated − measured)², without its mean where that is unknown
  double data = 0.0;   ///< Σ measured²
  void add(const PreparedRecording& recording, model::Channel channel, const Response& response, Window window);
};

/// Sums over all held-out windows of a channel. `responses`: read_all() of a hypothesis.
[[nodiscard]] SquaredError held_out_squares(const IdentificationProblem& problem,
                                            const std::vector<Response>& responses, model::Channel channel);

}  // namespace host_sim::identification
