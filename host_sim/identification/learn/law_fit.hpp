// A candidate model with a law in it, fitted by simulation error.
#pragma once

#include <vector>

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// What a fit with laws holds free: the common parameters of a search, the values of the laws, faults of the
/// recordings, and the parameters of effects last.
[[nodiscard]] std::vector<FreeParameter> parameters_with_laws(const SearchSpace& space, const Hypothesis& hypothesis,
                                                              const std::vector<firmware::PlacedEffect>& effects);

/// The hypothesis without its effects outside of `kept` that `from` does not have.
[[nodiscard]] Hypothesis with_effects(const SearchSpace& space, const Hypothesis& from,
                                      const std::vector<firmware::PlacedEffect>& kept);

/// Fits all of it (estimate/fit.hpp) in `most` steps, and finds the Jacobian at the minimum.
[[nodiscard]] CandidateModel fitted_with_laws(const IdentificationProblem& problem, const SearchSpace& space,
                                              const Hypothesis& start, std::vector<firmware::PlacedEffect> effects,
                                              int most);

}  // namespace host_sim::identification
