// Prediction error of a hypothesis on data that no fit has used.
#pragma once

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// χ² of the held-out windows of recordings that are fitted in part, begin at rest, or need no start
/// (PreparedRecording::settles): nothing is fitted here. 0 where nothing is held out that way.
///
/// Two models with their parameters from the fitted windows differ there by −2 ln of the ratio of their likelihoods on
/// data that chose neither; beside (1) of SelectionCriterion it is evidence without a penalty. Source: prequential
/// analysis, A. P. Dawid, J. R. Stat. Soc. A 147, 1984.
[[nodiscard]] double held_out_chi_squared(const IdentificationProblem& problem, const Hypothesis& hypothesis);

/// Residuals that it is the sum of.
[[nodiscard]] std::size_t held_out_count(const IdentificationProblem& problem);

/// χ² of a model in the fitted windows, with its n residuals, and in the held-out ones.
struct Explained {
  double fitted = 0.0, residuals = 0.0, held_out = 0.0;
};
[[nodiscard]] Explained explained(const IdentificationProblem& problem, const Hypothesis& hypothesis);

/// true: `with` leaves less than a share of what `without` leaves beyond noise, and explains the held-out windows
/// nearly as well as the fitted ones (thresholds::held_out_like_fitted).
[[nodiscard]] bool leaves_at_most(double share, const Explained& with, const Explained& without);

}  // namespace host_sim::identification
