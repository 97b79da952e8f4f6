#include "host_sim/identification/select/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

namespace {

/// Whether the rig's state is known where the held-out window begins. It is known behind a fitted window, at rest, and
/// after a machine has settled (PreparedRecording::settles).
bool is_judged(const ProblemRecording& r) {
  return r.is_held_out() && (r.is_fitted() || r.samples->at_rest || r.samples->settles);
}

}  // namespace

double held_out_chi_squared(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!is_judged(r)) continue;
    const Response response =
        read_channels(hypothesis, *r.samples, r.samples->input, hypothesis.starts[i], r.held_out.to, r.resolution());
    std::vector<double> whitened(r.held_out_whitening->count());
    r.held_out_whitening->whiten(r.held_out_whitening->spectra(*r.samples, response), whitened.data());
    for (const double v : whitened) sum += v * v;
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

std::size_t held_out_count(const IdentificationProblem& problem) {
  std::size_t count = 0;
  for (const ProblemRecording& r : problem.recordings()) count += is_judged(r) ? r.held_out_whitening->count() : 0;
  return count;
}

Explained explained(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const Eigen::VectorXd left = residuals(problem, predict(problem, hypothesis));
  return {left.squaredNorm(), static_cast<double>(left.size()), held_out_chi_squared(problem, hypothesis)};
}

bool leaves_at_most(double share, const Explained& with, const Explained& without) {
  const double left = std::max(with.fitted - with.residuals, 0.0);
  const double all = std::max(without.fitted - without.residuals, 0.0);
  return left < share * all &&
         with.held_out * without.fitted <= thresholds::held_out_like_fitted * with.fitted * without.held_out;
}

}  // namespace host_sim::identification
