#include "host_sim/identification/estimate/left_by_fit.hpp"

#include <cmath>

namespace host_sim::identification {
namespace {

LeftByFit tested(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const std::vector<Response> responses = read_all(problem, hypothesis);
  return {unexplained_residual(problem, hypothesis, responses), find_rest(problem, hypothesis, responses)};
}

}  // namespace

std::string LeftByFit::words() const {
  if (by_band.significant) return by_band.words;
  return by_time.found() ? by_time.words() : std::string();
}

LeftByFit left_by(const IdentificationProblem& problem, const Fit& fitted) {
  LeftByFit left = tested(problem, fitted.hypothesis);
  if (left.by_band.significant || !left.by_time.found() || left.by_time.is_fitted) return left;
  const IdentificationProblem whole = problem.with_all_fitted();
  constexpr int most_steps = 6;
  const Fit again = fit(whole, fitted.hypothesis, fitted.parameters, most_steps);
  return std::isfinite(again.chi_squared) ? tested(whole, again.hypothesis) : left;
}

}  // namespace host_sim::identification
