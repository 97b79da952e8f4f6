// Step 6: laws that no catalogue holds, learned where the search leaves a rest.
#pragma once

#include "host_sim/identification/learn/learned_law.hpp"
#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// Where the model that was found leaves more than noise, or its effects depend on the amplitude:
///
///   1  a free curve (curve_fit.hpp) at each place, over velocity and over deflection, beside the effects that act
///      elsewhere: by linearised gain the best few are fitted
///   2  families in its place (curve_family.hpp), the best few fitted by simulation error; the curve itself where none
///      explains as much
///   3  the law is kept where it explains more than the effects did (SelectionCriterion, and the held-out windows) and
///      nothing but noise is left beside it
///   4  where none is, a free surface over deflection and velocity is tried as they were (surface_fit.hpp)
///
/// A law that is kept stands in found.best, in the place of the effects that it makes needless. Where it leaves a rest
/// a second one is learned beside it: a curve beside branches with memory, or over the other variable.
[[nodiscard]] Learned learn_laws(IdentificationProblem& problem, const SearchSpace& space,
                                 const ProgressCallback& progress, SearchResult& found);

}  // namespace host_sim::identification
