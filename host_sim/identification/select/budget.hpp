// The work that a diagnosis may spend.
#pragma once

#include <string>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

struct SearchResult;

/// [steps of the model] What all simulations of the problem's recordings have cost so far (prepare/spent_work.hpp).
[[nodiscard]] double spent_work(const IdentificationProblem& problem);

/// [steps of the model] What may be spent: thresholds::most_work for each recording that is fitted.
[[nodiscard]] double most_work(const IdentificationProblem& problem);

/// The part of most_work() that one stage may spend: half of what is left when it begins, so that none leaves
/// nothing to the next. A stage asks between its steps and ends with what it has; what it leaves out is said. The same
/// recordings get the same answer on every machine.
class StageBudget {
 public:
  explicit StageBudget(const IdentificationProblem& problem);
  [[nodiscard]] bool is_spent(const IdentificationProblem& problem) const { return spent_work(problem) >= end_; }
  /// Else `step` enters SearchResult::not_tried.
  [[nodiscard]] bool allows(const IdentificationProblem& problem, const std::string& step, SearchResult& found) const;

 private:
  double end_;  ///< [steps of the model]
};

/// True if a stage may begin: less than most_work() is spent. Else it enters SearchResult::not_tried under the
/// name `stage`.
[[nodiscard]] bool may_begin(const IdentificationProblem& problem, const std::string& stage, SearchResult& found);

/// Adds to `found` the steps that another search left out, of which only this one is kept.
void add_not_tried(const SearchResult& other, SearchResult& found);

}  // namespace host_sim::identification
