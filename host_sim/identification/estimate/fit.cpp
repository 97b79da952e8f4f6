#include "host_sim/identification/estimate/fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/least_squares/gauss_newton.hpp"
#include "host_sim/least_squares/gram.hpp"

namespace host_sim::identification {
namespace {

Hypothesis moved(const Hypothesis& from, const FreeParameter& parameter, double u) {
  Hypothesis hypothesis = from;
  parameter.put(hypothesis, u);
  return hypothesis;
}

bool is_rig(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  return !firmware::find_rig_fault(hypothesis.rig, problem.sample_period());
}

/// The other end of a one-sided difference, towards the inside of the bounds.
struct Difference {
  Hypothesis other;
  double step;  ///< of u
};
Difference difference_of(const IdentificationProblem& problem, const Fit& at, const FreeParameter& parameter) {
  const double u = parameter.get(at.hypothesis);
  const double step = u + parameter.difference > parameter.upper ? -parameter.difference : parameter.difference;
  Hypothesis other = moved(at.hypothesis, parameter, u + step);
  if (is_rig(problem, other)) return {std::move(other), step};
  return {moved(at.hypothesis, parameter, u - step), -step};  // a delay as long as its line
}

/// Columns of J of sensors' parameters: without a simulation.
void find_sensor_columns(const IdentificationProblem& problem, Fit& at, const std::vector<std::size_t>& columns) {
  for_all(columns.size(), [&](std::size_t i) {
    const FreeParameter& parameter = at.parameters[columns[i]];
    const auto [other, step] = difference_of(problem, at, parameter);
    at.jacobian.col(static_cast<Eigen::Index>(columns[i])) =
        (residuals(problem, predict_readings(problem, other, at.prediction, parameter.readings)) - at.residual) / step;
  });
}

/// The other columns, with their simulations side by side. With corners both ends of the differences are predicted with
/// half of the steps.
void find_simulated_columns(const IdentificationProblem& problem, Fit& at, const std::vector<std::size_t>& columns) {
  if (columns.empty()) return;
  const bool halved = is_stepped_finely(at.hypothesis.rig);
  std::vector<Variation> variations;
  std::vector<double> steps;
  for (const std::size_t column : columns) {
    const FreeParameter& parameter = at.parameters[column];
    auto [other, step] = difference_of(problem, at, parameter);
    variations.push_back({std::move(other), std::nullopt});
    if (parameter.role == FreeParameter::Role::start) variations.back().recording = parameter.recording;
    steps.push_back(step);
  }
  if (halved) variations.push_back({at.hypothesis, std::nullopt});
  const std::vector<Eigen::VectorXd> values =
      residuals_of_each(problem, variations, true, halved ? nullptr : &at.prediction);
  const Eigen::VectorXd& base = halved ? values.back() : at.residual;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    at.jacobian.col(static_cast<Eigen::Index>(columns[i])) = (values[i] - base) / steps[i];
  }
}

/// Columns of J from `first` on.
void find_columns(const IdentificationProblem& problem, Fit& at, Eigen::Index first) {
  std::vector<std::size_t> of_sensors, simulated;
  for (auto i = static_cast<std::size_t>(first); i < at.parameters.size(); ++i) {
    (at.parameters[i].readings.empty() ? simulated : of_sensors).push_back(i);
  }
  find_sensor_columns(problem, at, of_sensors);
  find_simulated_columns(problem, at, simulated);
}

/// A fit as gauss_newton() sees it.
class FitProblem {
 public:
  FitProblem(const IdentificationProblem& problem, Fit& fit, Eigen::Index known_columns)
      : problem_(problem), fit_(fit), known_columns_(known_columns) {}

  bool find_jacobian() {
    find_columns(problem_, fit_, known_columns_);
    hessian_ = gram(fit_.jacobian);
    return fit_.jacobian.allFinite();
  }
  [[nodiscard]] NormalEquations normal_equations() const {
    return {hessian_, transposed_product(fit_.jacobian, fit_.residual)};
  }
  [[nodiscard]] StepBox box(double trust) const { return step_box(fit_.parameters, fit_.hypothesis, trust); }
  [[nodiscard]] double chi_squared() const { return fit_.chi_squared; }

  std::optional<double> try_step(const Eigen::VectorXd& d) {
    tried_ = fit_.hypothesis;
    for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
      const FreeParameter& parameter = fit_.parameters[i];
      parameter.put(tried_, parameter.get(fit_.hypothesis) + d(static_cast<Eigen::Index>(i)));
    }
    if (!is_rig(problem_, tried_)) return std::nullopt;
    tried_prediction_ = predict(problem_, tried_);
    tried_residual_ = residuals(problem_, tried_prediction_);
    return tried_residual_.squaredNorm();
  }
  void accept() {
    fit_.hypothesis = std::move(tried_);
    fit_.prediction = std::move(tried_prediction_);
    fit_.residual = std::move(tried_residual_);
    fit_.chi_squared = fit_.residual.squaredNorm();
  }

 private:
  const IdentificationProblem& problem_;
  Fit& fit_;
  Eigen::Index known_columns_;
  Eigen::MatrixXd hessian_;  ///< of the Jacobian, which is kept over several steps
  Hypothesis tried_;
  Prediction tried_prediction_;
  Eigen::VectorXd tried_residual_;
};

}  // namespace

StepBox step_box(const std::vector<FreeParameter>& parameters, const Hypothesis& hypothesis, double trust) {
  const auto n = static_cast<Eigen::Index>(parameters.size());
  StepBox box{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& parameter = parameters[static_cast<std::size_t>(i)];
    const FreeParameter::StepBounds bounds = parameter.step_bounds(parameter.get(hypothesis), trust);
    box.lower(i) = bounds.lower;
    box.upper(i) = bounds.upper;
  }
  return box;
}

void refresh_jacobian(const IdentificationProblem& problem, Fit& fit) {
  fit.jacobian.resize(fit.residual.size(), static_cast<Eigen::Index>(fit.parameters.size()));
  find_columns(problem, fit, 0);
}

std::vector<double> last_differences(const Fit& fit) {
  std::vector<double> differences;
  for (const FreeParameter& parameter : fit.parameters) differences.push_back(parameter.difference);
  if (!has_corners(fit.hypothesis.rig) || fit.jacobian.cols() == 0 || !fit.jacobian.allFinite()) return differences;
  const Eigen::VectorXd variances = fit.covariance().diagonal();
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const double variance = variances(static_cast<Eigen::Index>(i));
    if (!(variance > 0.0)) continue;
    differences[i] = std::min(differences[i], thresholds::corner_difference * std::sqrt(variance));
  }
  return differences;
}

void refine_jacobian(const IdentificationProblem& problem, Fit& fit) {
  const std::vector<double> differences = last_differences(fit);
  std::vector<Variation> variations;
  std::vector<double> apart(differences.size(), 0.0);
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FreeParameter& parameter = fit.parameters[i];
    for (const double by : {differences[i], -differences[i]}) {
      Hypothesis other = moved(fit.hypothesis, parameter, parameter.get(fit.hypothesis) + by);
      const bool possible = is_rig(problem, other);
      if (possible) apart[i] += differences[i];
      variations.push_back({possible ? std::move(other) : fit.hypothesis, std::nullopt});
      if (parameter.role == FreeParameter::Role::start) variations.back().recording = parameter.recording;
    }
  }
  const std::vector<Eigen::VectorXd> values = residuals_of_each(problem, variations, false, &fit.prediction);
  for (std::size_t i = 0; i < apart.size(); ++i) {
    if (!(apart[i] > 0.0)) continue;
    const Eigen::VectorXd column = (values[2 * i] - values[2 * i + 1]) / apart[i];
    if (column.allFinite()) fit.jacobian.col(static_cast<Eigen::Index>(i)) = column;
  }
}

Eigen::MatrixXd Fit::covariance() const {
  Eigen::MatrixXd h = gram(jacobian);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    h(k, k) += 1e-12 * h(k, k) + 1e-30;
    const double width = parameters[i].upper - parameters[i].lower;
    // Where a machine begins shows nowhere while the model has none: then it is known to its bounds alone.
    const bool bounded =
        parameters[i].role == FreeParameter::Role::tolerated || parameters[i].role == FreeParameter::Role::start;
    if (bounded) h(k, k) += 12.0 / (width * width);
  }
  return h.ldlt().solve(Eigen::MatrixXd::Identity(h.rows(), h.cols()));
}

Fit fit(const IdentificationProblem& problem, Hypothesis start, std::vector<FreeParameter> parameters, int most,
        const Eigen::MatrixXd& known_jacobian) {
  Fit result;
  result.hypothesis = std::move(start);
  result.parameters = std::move(parameters);
  result.prediction = predict(problem, result.hypothesis);
  result.residual = residuals(problem, result.prediction);
  result.chi_squared = result.residual.squaredNorm();
  if (!std::isfinite(result.chi_squared)) result.chi_squared = std::numeric_limits<double>::infinity();
  result.jacobian.resize(result.residual.size(), static_cast<Eigen::Index>(result.parameters.size()));
  const Eigen::Index known = known_jacobian.cols();
  if (known > 0) result.jacobian.leftCols(known) = known_jacobian;
  FitProblem fitted(problem, result, known);
  if (!result.parameters.empty()) gauss_newton(fitted, {.most_steps = most});
  return result;
}

}  // namespace host_sim::identification
