// The work that a diagnosis may spend.
#pragma once

#include <string>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// [steps of the model] What may be spent: thresholds::most_work for each recording that is fitted.
[[nodiscard]] double most_work(const IdentificationProblem& problem);

/// The part of most_work() that one stage may spend: half of what is left when it begins, so that none leaves
/// nothing to the next. A stage asks between its steps and ends with what it has; what it leaves out is said. The same
/// recordings get the same answer on every machine.
class StageBudget {
 public:
  explicit StageBudget(const IdentificationProblem& problem);
  [[nodiscard]] bool is_spent(const IdentificationProblem& problem) const { return problem.work().steps() >= end_; }
  /// Else `step` is left out (SpentWork::leave_out).
  [[nodiscard]] bool allows(const IdentificationProblem& problem, const std::string& step) const;

 private:
  double end_;  ///< [steps of the model]
};

/// True if a stage may begin: less than most_work() is spent. Else it is left out under the name `stage`.
[[nodiscard]] bool may_begin(const IdentificationProblem& problem, const std::string& stage);

}  // namespace host_sim::identification
