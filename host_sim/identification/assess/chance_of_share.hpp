// How well a cause that is none would do by chance beside what no cause explains.
#pragma once

#include <cstddef>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// Where a model is not the rig it leaves a discrepancy, a reproducible function of the motion in a few directions that
/// nobody knows, K of each channel in each band (estimate/evidence.hpp). Bands count as far as something is left in them:
///
///   (1)  D = K (Σ p_cb)²/Σ p_cb²      p_cb: power of what is left, relative to that of the channel; all windows
[[nodiscard]] double directions_left(const IdentificationProblem& problem, Hypothesis hypothesis);

/// A cause that has nothing to do with the discrepancy still takes a part of it away: of one direction among D that the
/// discrepancy does not know, cos² of the angle between the two. So does the best of `tried` candidates. Such a one
/// explains at least a share s of the error with a probability of at most
///
///   (2)  chance = min(1, tried · P),   P = ∫₀^θ sin^(D−2) dφ / ∫₀^(π/2) sin^(D−2) dφ,   cos²θ = 1 − (1 − s)²
///
/// 1 for s ≤ 0. It says nothing of laws that resemble a cause (named_effect.hpp, 3). Sources: cos² is Beta(½, (D−1)/2),
/// R. Muirhead, Aspects of Multivariate Statistical Theory, 1982, theorem 1.5.7; C. Bonferroni for the best of many.
[[nodiscard]] double chance_of_share(double share, double directions, std::size_t tried);

}  // namespace host_sim::identification
