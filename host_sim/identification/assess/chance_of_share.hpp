// How well a cause that is none would do by chance beside what no cause explains.
#pragma once

#include <cstddef>
#include <vector>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// What a model leaves of a channel.
struct ChannelRest {
  double left = 0.0;        ///< Σ (simulated − measured)² [SI²]
  double excess = 0.0;      ///< beyond noise, at least the share of noise that is not known [SI²]
  double directions = 0.0;  ///< D
};

/// Where a model is not the rig it leaves a discrepancy, a reproducible function of the motion in a few directions that
/// nobody knows, K in each band (estimate/evidence.hpp). Bands count as far as something beyond noise is left in them:
///
///   (1)  D = K (Σ p_b)²/Σ p_b²       p_b: power that is left in band b of a channel, less its noise
///
/// Of each channel of the problem, from all windows that are fitted or held out. Noise is known to
/// thresholds::significant_share of it, and taken for white here.
[[nodiscard]] std::vector<ChannelRest> rest_of_channels(const IdentificationProblem& problem, Hypothesis hypothesis);

/// A cause that has nothing to do with the discrepancy still takes a part of it away: of one direction among D that the
/// discrepancy does not know, cos² of the angle between the two. So does the best of `tried` candidates. Such a one
/// takes at least the share x of what is left of a channel away with a probability of at most
///
///   (2)  chance = min(1, tried · P),   P = ∫₀^θ sin^(D−2) dφ / ∫₀^(π/2) sin^(D−2) dφ,   cos²θ = x
///
/// 1 for x ≤ 0. It says nothing of laws that resemble a cause (named_effect.hpp, 3). Sources: cos² is Beta(½, (D−1)/2),
/// R. Muirhead, Aspects of Multivariate Statistical Theory, 1982, theorem 1.5.7; C. Bonferroni for the best of many.
[[nodiscard]] double chance_of_share(double share, double directions, std::size_t tried);

/// The least chance (2) of the channels, in all that is left and in what is left beyond noise: a noise that is said too
/// loud hides in the second what the first shows. Each is a trial more. `with`, `without` a cause: rest_of_channels().
[[nodiscard]] double chance_of_cause(const std::vector<ChannelRest>& with, const std::vector<ChannelRest>& without,
                                     std::size_t tried);

}  // namespace host_sim::identification
