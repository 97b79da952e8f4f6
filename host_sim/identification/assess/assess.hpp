// Steps 6 and 7: what the selected model explains, how sure that is, and what is left.
#pragma once

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/estimate/virtual_car_estimate.hpp"
#include "host_sim/identification/learn/learned_law.hpp"

namespace host_sim::identification {

/// From the selected model to a verdict:
///
///   1  starts of held-out recordings, χ² per residual, the unexplained residual      estimate/unexplained_residual.hpp
///   2  effects with intervals, confidence and rivals                                 named_effect.hpp
///   3  the virtual tyre's effects, which the real-time program itself computes       estimate/virtual_car_estimate.hpp
///   4  verdict   no_discrepancy  nothing named, nothing left
///                unexplained     something is left, and less than thresholds::explains_all explained, or a channel's
///                                error on held-out data is as large as its signal
///                ambiguous       a rival has odds below thresholds::close_odds
///                named           else
///   5  where the disagreement sits, prediction errors on held-out data, curves for figures, the rig with all of it
[[nodiscard]] Diagnosis assess(const firmware::RigDescription& description, const IdentificationProblem& problem,
                               const SearchSpace& space, std::vector<ParityResidual> relations, SearchResult found,
                               Learned learned);

}  // namespace host_sim::identification
