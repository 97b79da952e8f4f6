// Step 4: parameters of a hypothesis by least squares over whitened residuals.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "host_sim/identification/estimate/free_parameter.hpp"
#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/least_squares/bounded_step.hpp"

namespace host_sim::identification {

/// A fitted hypothesis: the maximum of the likelihood of noise/whitening.hpp inside the bounds,
///
///   (1)  χ²(u) = |r(u)|²,   r: whitened residuals of all fitted windows
///   (2)  J = ∂r/∂u by one-sided differences
///   (3)  covariance of u = (JᵀJ + diag(12/width²) of tolerated parameters)⁻¹
///
/// (3): inside its tolerance a parameter is anywhere before the data are looked at, which has the variance width²/12.
struct Fit {
  Hypothesis hypothesis;
  std::vector<FreeParameter> parameters;
  Prediction prediction;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;  ///< J at or near the minimum
  double chi_squared = 0.0;

  /// (3); also of parameters at a bound: a bound says where the truth is not, not where it is.
  [[nodiscard]] Eigen::MatrixXd covariance() const;
};

/// Steps of parameters from where a hypothesis has them; `trust`: share of the trust radius.
[[nodiscard]] StepBox step_box(const std::vector<FreeParameter>& parameters, const Hypothesis& hypothesis,
                               double trust);

/// Minimises (1) from `start` with the workbench's one solver (least_squares/gauss_newton.hpp), in `most` steps at
/// most. `known_jacobian`: columns of J for the first parameters that are kept as they are; the others are found anew.
/// A simulation that diverges counts as an infinite χ².
[[nodiscard]] Fit fit(const IdentificationProblem& problem, Hypothesis start, std::vector<FreeParameter> parameters,
                      int most = 12, const Eigen::MatrixXd& known_jacobian = {});

/// Finds J of a fit anew, at its minimum.
void refresh_jacobian(const IdentificationProblem& problem, Fit& fit);

/// Differences of each parameter's coordinate for slopes at the end of a fit: its own, and with corners no more than
/// thresholds::corner_difference standard deviations, as far as the fit's Jacobian knows them. Over more, friction
/// turns and free play ends in other samples, which is worth more than the slope.
[[nodiscard]] std::vector<double> last_differences(const Fit& fit);

/// J anew by central differences over ± last_differences(), with all steps.
void refine_jacobian(const IdentificationProblem& problem, Fit& fit);

}  // namespace host_sim::identification
