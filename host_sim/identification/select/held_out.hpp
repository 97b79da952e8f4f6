// Prediction error of a hypothesis on data that no fit has used.
#pragma once

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// χ² of the held-out windows of recordings that are fitted in part: their start is known, so nothing is fitted here.
/// 0 where nothing is held out that way.
///
/// Two models with their parameters from the fitted windows differ there by −2 ln of the ratio of their likelihoods on
/// data that chose neither; beside (1) of SelectionCriterion it is evidence without a penalty. Source: prequential
/// analysis, A. P. Dawid, J. R. Stat. Soc. A 147, 1984.
[[nodiscard]] double held_out_chi_squared(const IdentificationProblem& problem, const Hypothesis& hypothesis);

}  // namespace host_sim::identification
