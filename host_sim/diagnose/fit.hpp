// Parameters by least squares over whitened residuals.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/diagnose/hypothesis.hpp"
#include "host_sim/diagnose/readings.hpp"
#include "host_sim/diagnose/whitening.hpp"

namespace host_sim::diagnose {

/// The recordings and what their residuals are measured with.
struct Case {
  std::vector<Evidence> evidence;
  std::vector<Whitening> fit;  ///< by recording; a window of size 0 has none
  std::vector<Whitening> judge;
  std::vector<std::size_t> fitted, judged;  ///< which recordings these belong to
  double model_error = 0.0;                 ///< ε_c of Whitening (2)
};

/// What a hypothesis says of the fitted windows, by fitted recording.
struct Prediction {
  std::vector<std::shared_ptr<const Response>> truth;  ///< channels before their sensors
  std::vector<Spectra> seen;                           ///< of the readings
};
[[nodiscard]] Prediction predict(const Case& all, const Hypothesis& hypothesis, Steps steps = Steps::fine);

/// The same where `hypothesis` differs from that of `base` by nothing but the sensor of one channel: no simulation.
[[nodiscard]] Prediction predict_sensor(const Case& all, const Hypothesis& hypothesis, const Prediction& base,
                                        model::Channel channel);

/// Whitened residuals of the fitted windows, recording after recording.
[[nodiscard]] Eigen::VectorXd residuals(const Case& all, const Prediction& prediction);

/// Readings of every recording in full.
[[nodiscard]] std::vector<Response> respond(const Case& all, const Hypothesis& hypothesis);

/// How far each coordinate may go: lower <= d <= upper.
struct Box {
  Eigen::VectorXd lower, upper;
};
/// … of unknowns from where a hypothesis has them, `trust` being the share of what slopes may be believed for.
[[nodiscard]] Box box_of(const std::vector<Unknown>& unknowns, const Hypothesis& hypothesis, double trust);

/// The minimum of ½|r + J d|² in a box, from its normal equations H = JᵀJ, g = Jᵀr (active set).
[[nodiscard]] Eigen::VectorXd bounded_step(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Box& box);

/// A fitted hypothesis.
struct Fit {
  Hypothesis hypothesis;
  std::vector<Unknown> unknowns;
  Prediction prediction;
  Eigen::VectorXd residual;
  Eigen::MatrixXd slope;  ///< J = ∂r/∂u at or near the minimum
  double chi_squared = 0.0;
  std::size_t simulations = 0;  ///< that it took

  /// Covariance of the coordinates u, (JᵀJ)⁻¹; unknowns at a bound count as known.
  [[nodiscard]] Eigen::MatrixXd covariance() const;
};

/// Gauss–Newton with bounds: each step is shortened until χ² falls; ends when it falls by less than 0.01 + 1e-6 χ², or
/// after `most` steps. Slopes are kept while steps hold 70 % of what they promise. `known_slope`: columns of J for the
/// first unknowns that may be taken as they are; the others' are found anew in each step.
[[nodiscard]] Fit fit(const Case& all, Hypothesis start, std::vector<Unknown> unknowns, int most = 12,
                      const Eigen::MatrixXd& known_slope = {});

/// J of a fit, found anew where it is.
void refresh_slope(const Case& all, Fit& fit);

}  // namespace host_sim::diagnose
