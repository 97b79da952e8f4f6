// Step 5: the model that the recordings support.
#pragma once

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// χ² per residual beyond noise: the share that effects explain of what refitted tolerances leave.
///
///   (1)  1 − max(χ²/n − 1, 0) / max(χ²_refit/n − 1, 1/n)
[[nodiscard]] double explained_share(double refit_per_residual, double after_per_residual, double count);

/// A model is the whole of it where (1) ≥ thresholds::explains_all, or only noise is left:
///
///   1  forward selection
///   2  elimination and swaps, unless the model explains too little to become the whole (thresholds::explains_most)
///   3  where it is not the whole: the search under model error
///   4  parameters of the description compete with the effects (suspect_parameters.hpp)
///   5  where more than noise is left, or two effects may be one such law: steps 1, 2 and 4 with the laws that could
///      imitate others (EffectCard::imitates). Their result is taken
///      - where it leaves nothing but noise, or nearly nothing (thresholds::nearly_all)
///      - in the place of two effects that leave nothing but noise, where it costs less by (1) of SelectionCriterion
///      - where more than noise is left with it, too: if it has fewer effects, costs less, and each such law in it has
///        one parameter, which no value bends into another law
[[nodiscard]] SearchResult select_model(IdentificationProblem& problem, const SearchSpace& space,
                                        const ProgressCallback& progress);

/// Steps 1, 2 and 4: where only a model that leaves nothing but noise is of use.
[[nodiscard]] SearchResult select_in_noise(IdentificationProblem& problem, const SearchSpace& space,
                                           const ProgressCallback& progress);

/// Whether a model leaves more than noise, and explains less than `share` of what `nothing` leaves.
[[nodiscard]] bool leaves_more(const IdentificationProblem& problem, const CandidateModel& model,
                               const CandidateModel& nothing, double share);

/// χ² per residual, at least 1: what odds are divided by where a model is not the whole.
[[nodiscard]] double temper_of(const Fit& fit);
/// Whether more than noise is left, or an effect is another one than its law says.
[[nodiscard]] bool leaves_a_rest(const IdentificationProblem& problem, const SearchResult& found);
/// Nothing but noise is left: in no band, in no stretch of time.
[[nodiscard]] bool is_whole(const IdentificationProblem& problem, const Fit& fit);

}  // namespace host_sim::identification
