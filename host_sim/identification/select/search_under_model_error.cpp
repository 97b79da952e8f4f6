#include "host_sim/identification/select/search_under_model_error.hpp"

#include <cstdio>
#include <limits>
#include <utility>

#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// Smaller steps than a search in units of noise takes.
SelectionCriterion criterion_under_model_error(bool sensors) {
  SelectionCriterion criterion;
  criterion.later_share = 0.1;
  criterion.sensors = sensors;
  criterion.faults = false;  // like sensors, clocks and filters bend channels into place
  criterion.beam = 1;
  criterion.most_candidates = 5;
  criterion.most_rivals = 3;
  return criterion;
}

/// Searches a part of the problem and refits on the whole. Rivals are compared only where the model's pooled error is
/// below `worth_comparing`.
SearchResult search_part(IdentificationProblem& problem, const SearchSpace& space, const SearchOptions& options,
                         double worth_comparing) {
  const double seconds = thresholds::seconds_under_model_error / static_cast<double>(problem.fitted_count());
  // What coarse steps get wrong is small beside the error that is allowed for.
  IdentificationProblem part = problem.truncated_and_coarse(share_with(problem, seconds));
  SearchResult found = search(part, space, options);
  problem.take_input_noise(part);
  if (worth_comparing < std::numeric_limits<double>::infinity()) {
    SearchResult whole = found;
    refit_on(problem, space, options.criterion, whole);
    if (!(pooled_error(problem, whole.best.fit.hypothesis) < worth_comparing)) return whole;
  }
  compare(part, space, options, found);
  problem.take_input_noise(part);
  refit_on(problem, space, options.criterion, found);
  return found;
}

std::string sensor_remark(const SearchResult& rival, double error, double left) {
  std::vector<std::string> names;
  for (const firmware::PlacedEffect& effect : rival.best.effects) names.push_back(words(effect));
  char change[64];
  std::snprintf(change, sizeof change, " would leave an error of %.3g %%, instead of %.3g %%", 100.0 * error,
                100.0 * left);
  return joined(names) + change + ": rivals of what is listed, which has fewer causes in sensors";
}

}  // namespace

bool search_under_model_error(IdentificationProblem& problem, const SearchSpace& space,
                              const ProgressCallback& progress, SearchResult& found) {
  const IdentificationProblem before = problem;
  double left = pooled_error(problem, found.best.fit.hypothesis);
  problem.allow_model_error(left);
  double to_beat = thresholds::replaces_error * left;
  bool replaced = false;
  const StageBudget budget(problem);
  for (const bool sensors : {false, true}) {
    if (sensors && !budget.allows(problem, "sensors under model error")) break;
    const SearchOptions options{criterion_under_model_error(sensors), false, progress};
    SearchResult again =
        search_part(problem, space, options, sensors ? to_beat : std::numeric_limits<double>::infinity());
    const double error = pooled_error(problem, again.best.fit.hypothesis);
    again.remarks = found.remarks;
    if (error < to_beat) {
      found = std::move(again);
      replaced = true;
      left = error;
      to_beat = thresholds::sensors_replace_error * error;
      continue;
    }
    if (sensors && error < thresholds::replaces_error * left) {
      found.remarks.push_back(sensor_remark(again, error, left));
    }
  }
  if (!replaced) problem.take_input_noise(before);
  problem.allow_model_error(0.0);
  return replaced;
}

}  // namespace host_sim::identification
