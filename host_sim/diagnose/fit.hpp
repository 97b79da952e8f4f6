// Parameters by least squares over whitened residuals.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/diagnose/hypothesis.hpp"
#include "host_sim/diagnose/whitening.hpp"

namespace host_sim::diagnose {

/// The recordings and what their residuals are measured with.
struct Case {
  std::vector<Evidence> evidence;
  std::vector<Whitening> fit;  ///< by recording; a window of size 0 has none
  std::vector<Whitening> judge;
  std::vector<std::size_t> fitted, judged;  ///< which recordings these belong to
};

/// All whitened residuals of a hypothesis, recording after recording: fitted windows, or those held out.
[[nodiscard]] Eigen::VectorXd residuals(const Case& all, const Hypothesis& hypothesis);

/// The same where the responses are known.
[[nodiscard]] Eigen::VectorXd residuals(const Case& all, const std::vector<Response>& responses, bool held_out);
[[nodiscard]] std::vector<Response> respond(const Case& all, const Hypothesis& hypothesis);

/// The minimum of ½|r + J d|² with lower <= d <= upper, from its normal equations H = JᵀJ, g = Jᵀr (active set).
[[nodiscard]] Eigen::VectorXd bounded_step(const Eigen::MatrixXd& h, const Eigen::VectorXd& g,
                                           const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

/// ∂r/∂u of each unknown by one-sided differences, at a hypothesis with residuals r.
[[nodiscard]] Eigen::MatrixXd jacobian(const Case& all, const Hypothesis& hypothesis,
                                       const std::vector<Unknown>& unknowns, const Eigen::VectorXd& r);

/// A fitted hypothesis.
struct Fit {
  Hypothesis hypothesis;
  std::vector<Unknown> unknowns;
  Eigen::VectorXd residual;
  Eigen::MatrixXd slope;  ///< J at or near the minimum
  double chi_squared = 0.0;

  /// Covariance of the coordinates u, (JᵀJ)⁻¹; unknowns at a bound count as known.
  [[nodiscard]] Eigen::MatrixXd covariance() const;
};

/// Gauss–Newton with bounds: each step is shortened until χ² falls; ends when it falls by less than 0.01 + 1e-6 χ², or
/// after `most` steps. `known_slope`: columns of J for the first unknowns that may be taken as they are; the others'
/// are found anew in each step.
[[nodiscard]] Fit fit(const Case& all, Hypothesis start, std::vector<Unknown> unknowns, int most = 12,
                      const Eigen::MatrixXd& known_slope = {});

}  // namespace host_sim::diagnose
