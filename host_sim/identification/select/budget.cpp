#include "host_sim/identification/select/budget.hpp"

#include <algorithm>

#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

bool allow(bool allowed, const IdentificationProblem& problem, const std::string& step) {
  if (!allowed) problem.work().leave_out(step);
  return allowed;
}

}  // namespace

double most_work(const IdentificationProblem& problem) {
  return thresholds::most_work * static_cast<double>(std::max<std::size_t>(1, problem.fitted_count()));
}

StageBudget::StageBudget(const IdentificationProblem& problem) : end_(problem.work().steps()) {
  end_ += 0.5 * std::max(most_work(problem) - end_, 0.0);
}

bool StageBudget::allows(const IdentificationProblem& problem, const std::string& step) const {
  return allow(!is_spent(problem), problem, step);
}

bool may_begin(const IdentificationProblem& problem, const std::string& stage) {
  return allow(problem.work().steps() < most_work(problem), problem, stage);
}

}  // namespace host_sim::identification
