#include "host_sim/identification/estimate/lower_minimum.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"

namespace host_sim::identification {
namespace {

/// Independent numbers of variance 1, nearly normal: sums of twelve uniform ones, the same with every standard library.
class NormalNumbers {
 public:
  Eigen::VectorXd operator()(Eigen::Index count) {
    constexpr int terms = 12;  // each of variance 1/12
    Eigen::VectorXd numbers(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      double sum = 0.0;
      for (int k = 0; k < terms; ++k) sum += static_cast<double>(engine_() >> 11U) * 0x1.0p-53 - 0.5;
      numbers(i) = sum;
    }
    return numbers;
  }

 private:
  std::mt19937_64 engine_{1};
};

/// (1), inside the bounds.
Hypothesis beside(const Fit& fit, const Eigen::VectorXd& change) {
  const StepBox box = step_box(fit.parameters, fit.hypothesis, 1.0);
  Hypothesis hypothesis = fit.hypothesis;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const FreeParameter& parameter = fit.parameters[i];
    parameter.put(hypothesis, parameter.get(fit.hypothesis) + std::clamp(change(k), box.lower(k), box.upper(k)));
  }
  return hypothesis;
}

/// As long as slopes over what the data cannot tell apart lead down.
void follow_slopes(const IdentificationProblem& problem, Fit& fit) {
  for (int round = 0; round < thresholds::slope_rounds; ++round) {
    refine_jacobian(problem, fit);
    Fit on = identification::fit(problem, fit.hypothesis, fit.parameters, thresholds::lower_steps, fit.jacobian);
    const double gained = fit.chi_squared - on.chi_squared;
    if (gained > 0.0) fit = std::move(on);
    if (gained < thresholds::smooth_valley) break;
  }
}

}  // namespace

void find_lower_minimum(const IdentificationProblem& problem, Fit& fit) {
  if (fit.parameters.empty() || !has_corners(fit.hypothesis.rig)) return;
  refresh_jacobian(problem, fit);
  if (!fit.jacobian.allFinite()) return;
  follow_slopes(problem, fit);
  const Eigen::LLT<Eigen::MatrixXd> covariance(fit.covariance());
  if (covariance.info() != Eigen::Success) return;
  const Eigen::MatrixXd spread = covariance.matrixL();
  NormalNumbers normal;
  bool found = false;
  for (int round = 0; round < thresholds::lower_rounds; ++round) {
    std::array<Fit, 4> tries;
    std::array<Hypothesis, 4> starts;
    for (Hypothesis& start : starts) start = beside(fit, spread * normal(spread.rows()));
    for_all(tries.size(), [&](std::size_t i) {
      if (firmware::find_rig_fault(starts[i].rig, problem.sample_period())) return;
      tries[i] =
          identification::fit(problem, std::move(starts[i]), fit.parameters, thresholds::lower_steps, fit.jacobian);
    });
    Fit* best = nullptr;
    bool smooth = true;
    for (Fit& other : tries) {
      if (other.parameters.empty()) continue;
      smooth = smooth && std::abs(other.chi_squared - fit.chi_squared) < thresholds::smooth_valley;
      if (best == nullptr || other.chi_squared < best->chi_squared) best = &other;
    }
    if (smooth) break;
    if (best->chi_squared >= fit.chi_squared) continue;
    found = true;
    fit = std::move(*best);
  }
  if (found) follow_slopes(problem, fit);
}

}  // namespace host_sim::identification
