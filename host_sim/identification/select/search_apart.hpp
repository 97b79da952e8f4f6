// The search repeated with the machine of a bench and its component apart.
#pragma once

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// F says where the machine is as x_act does, so what the component's model gets wrong bends the machine. Where more
/// than noise is left of x_act, although a machine has few effects and no load acts on it:
///
///   1  the machine is found from x_act alone: every set of one and of two of its effects is fitted, and the set with
///      the least error on what is held out is it; a larger one must be better by thresholds::replaces_error
///   2  the component is found from F alone, moved by that machine; with laws that could imitate others where these
///      leave so much less of what is held out
///   3  both together replace `found` where the product of the channels' errors on held-out data falls as much: under
///      errors of the model of unknown size, Σ ln of them is what remains of the likelihood
///
/// Effects of sensors and faults of the recording are no candidates here: they bend channels into place. true: `found`
/// was replaced, and `problem` is one whose component that machine moves (IdentificationProblem::apart()).
[[nodiscard]] bool search_apart(IdentificationProblem& problem, const SearchSpace& space,
                                const ProgressCallback& progress, SearchResult& found);

}  // namespace host_sim::identification
