#include "host_sim/identification/select/select_model.hpp"

#include <algorithm>

#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/select/law_constancy.hpp"
#include "host_sim/identification/select/search_under_model_error.hpp"
#include "host_sim/identification/select/suspect_parameters.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// Whether more than noise is left, and less than `share` explained.
bool leaves_more(const IdentificationProblem& problem, const SearchResult& found, double share) {
  const auto count = static_cast<double>(found.best.fit.residual.size());
  const double explained =
      explained_share(found.nothing.fit.chi_squared / count, found.best.fit.chi_squared / count, count);
  return explained < share && unexplained_residual(problem, found.best.fit.hypothesis).significant;
}

}  // namespace

double explained_share(double refit_per_residual, double after_per_residual, double count) {
  return 1.0 - std::max(after_per_residual - 1.0, 0.0) / std::max(refit_per_residual - 1.0, 1.0 / count);
}

SearchResult select_in_noise(IdentificationProblem& problem, const SearchSpace& space,
                             const ProgressCallback& progress) {
  const SearchOptions options{{}, true, progress};
  SearchResult found = search(problem, space, options);
  compare(problem, space, options, found);
  compare_parameters(problem, space, progress, found);
  found.constancy = law_constancy(problem, found);
  return found;
}

SearchResult select_model(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress) {
  const SearchOptions options{{}, true, progress};
  SearchResult found = search(problem, space, options);
  const bool far = leaves_more(problem, found, thresholds::explains_most);
  if (!far) compare(problem, space, options, found);
  if (far || leaves_more(problem, found, thresholds::explains_all)) {
    const bool replaced = search_under_model_error(problem, space, progress, found);
    if (far && !replaced) compare(problem, space, options, found);
  }
  compare_parameters(problem, space, progress, found);
  found.constancy = law_constancy(problem, found);
  return found;
}

}  // namespace host_sim::identification
