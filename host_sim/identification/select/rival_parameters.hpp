// Parameters of the description that do what an effect was found to do.
#pragma once

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// For each effect that was found, the parameters that may be off in its place:
///
///   (1)  cos² = (eᵀP d)² / (eᵀP e · dᵀP d)      e: what the effect changes in the residuals, d: their slope over the
///                                               parameter, P: what everything else that was fitted leaves of it
///   (2)  1 − cos² ≤ max(thresholds::unlike, 2 ln thresholds::listed_odds / gain)
///
/// What (2) admits is fitted in the effect's place, bound by no tolerance, at the price of an effect with one
/// parameter and with the held-out windows. The prior of a described value, which decides what is named
/// (suspect_parameters.hpp, 1), has no part in it: whether recordings tell two causes apart is asked of them alone.
///
/// A parameter of the effect's own component whose slope is that of the effect's one number (thresholds::at_the_limit)
/// is no rival but the same said in other words: viscous damping, and the damping of the suspension.
///
/// Only where nothing but noise is left; effects that the values themselves show have no rivals. Source of (1): the
/// score test, as in linear_refit.hpp.
void find_rival_parameters(IdentificationProblem& problem, const SearchSpace& space, SearchResult& found);

}  // namespace host_sim::identification
