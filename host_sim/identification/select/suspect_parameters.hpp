// Parameters of the description as suspects: outside their tolerance, or described without one and not as described.
#pragma once

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// A search space in which these parameters are bound by no tolerance: within a factor of thresholds::parameter_range
/// of what is described.
[[nodiscard]] SearchSpace untied(const SearchSpace& space, const std::vector<FreeParameter>& parameters);

/// Parameters compete with the effects that were found, under the same criterion:
///
///   (1)  χ² + (effect + parameter + violation) · k       k parameters without a bound
///   (2)  violation = 2 ln 100                            a described value is off in one of a hundred rigs
///
///   1  the parameter whose linear gain is largest is freed and fitted, then the next beside it, as long as (1) falls
///      and each explains the share of an effect
///   2  where effects alone leave nothing but noise, the parameters replace them only if (1) is lower
///   3  where they do not: effects are searched for beside the freed parameters, and beside each suspect alone that
///      explains nearly as much as the first (thresholds::equal_suspects); the best result replaces the effects alone
///      if (1) is lower and the error on the recordings falls by thresholds::parameters_replace_error
///   4  of the better one, a parameter that is not worth its price is bound again, one is freed if more than noise is
///      left, and one effect or drift after the other is left out, with a parameter in its place where that costs too
///      much, or another effect with it (where a parameter stands at the bound of its tolerance also two effects at
///      once); an effect that is a limit of its law does what a parameter does, which takes its place where the two
///      cannot be told apart (thresholds::at_the_limit, tie)
///
/// Holds that the values themselves show stay in all of these.
///
/// `found` becomes the better of the two. Its `nothing` stays the rig with its tolerances refitted.
void compare_parameters(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                        SearchResult& found);

/// The same of a search whose effects were not compared yet: (1) to (3), and (4) only where parameters are better. Many
/// effects may be one parameter that is off, and comparing all of them is most of the work. false: `found` stays,
/// effects alone are better; its residuals may be weighted anew. `whole`: only parameters that explain everything are
/// asked for, so what leaves more than comparing could make good (thresholds::explains_most) is not compared.
[[nodiscard]] bool parameters_instead(IdentificationProblem& problem, const SearchSpace& space,
                                      const ProgressCallback& progress, SearchResult& found, bool whole = false);

}  // namespace host_sim::identification
