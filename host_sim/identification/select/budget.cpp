#include "host_sim/identification/select/budget.hpp"

#include <algorithm>

#include "host_sim/identification/select/search.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

bool allow(bool allowed, const std::string& what, SearchResult& found) {
  std::vector<std::string>& list = found.not_tried;
  if (!allowed && std::find(list.begin(), list.end(), what) == list.end()) list.push_back(what);
  return allowed;
}

}  // namespace

double most_work(const IdentificationProblem& problem) {
  return thresholds::most_work * static_cast<double>(std::max<std::size_t>(1, problem.fitted_count()));
}

double spent_work(const IdentificationProblem& problem) {
  double steps = 0.0;
  for (const PreparedRecording& r : problem.samples()) steps += r.work->steps();
  return steps;
}

StageBudget::StageBudget(const IdentificationProblem& problem) : end_(spent_work(problem)) {
  end_ += 0.5 * std::max(most_work(problem) - end_, 0.0);
}

bool StageBudget::allows(const IdentificationProblem& problem, const std::string& step, SearchResult& found) const {
  return allow(!is_spent(problem), step, found);
}

bool may_begin(const IdentificationProblem& problem, const std::string& stage, SearchResult& found) {
  return allow(spent_work(problem) < most_work(problem), stage, found);
}

void add_not_tried(const SearchResult& other, SearchResult& found) {
  for (const std::string& what : other.not_tried) allow(false, what, found);
}

}  // namespace host_sim::identification
