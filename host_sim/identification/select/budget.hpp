// The work that a search may spend.
#pragma once

#include <string>

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// Samples that were simulated in so many simulations of all fitted windows: the work of a search, whatever the
/// machine that does it. The same recordings get the same answer everywhere.
[[nodiscard]] double simulated_samples(const IdentificationProblem& problem, std::size_t simulations);

/// Whether the next step of a selection may begin: less than thresholds::most_simulated_samples were simulated. Else it
/// enters SearchResult::not_tried under the name `step`.
[[nodiscard]] bool may_begin(const IdentificationProblem& problem, const std::string& step, SearchResult& found);

}  // namespace host_sim::identification
