#include "host_sim/identification/select/budget.hpp"

#include <algorithm>

#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

double simulated_samples(const IdentificationProblem& problem, std::size_t simulations) {
  double samples = 0.0;
  for (const ProblemRecording& r : problem.recordings()) {
    if (r.is_fitted()) samples += static_cast<double>(r.fitted.to);
  }
  return samples * static_cast<double>(simulations);
}

bool may_begin(const IdentificationProblem& problem, const std::string& step, SearchResult& found) {
  if (simulated_samples(problem, found.simulations) < thresholds::most_simulated_samples) return true;
  if (std::find(found.not_tried.begin(), found.not_tried.end(), step) == found.not_tried.end()) {
    found.not_tried.push_back(step);
  }
  return false;
}

}  // namespace host_sim::identification
