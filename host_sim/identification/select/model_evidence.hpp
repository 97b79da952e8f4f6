// The evidence for a candidate model: what it leaves, what its causes and their parameters cost.
#pragma once

#include <vector>

#include "host_sim/identification/estimate/evidence.hpp"
#include "host_sim/identification/select/candidates.hpp"
#include "host_sim/identification/select/selection_criterion.hpp"

namespace host_sim::identification {

/// What a residual leaves of each channel in each band: channel by channel, noise_bands of each.
[[nodiscard]] std::vector<Power> power_by_band(const IdentificationProblem& problem, const Eigen::VectorXd& residual);

/// How an excess over noise counts: a power in the place of P, and how fast it grows with P (estimate/evidence.hpp).
struct Tempering {
  DiscrepancyModel discrepancy;
  bool by_power = true;  ///< (6) of estimate/evidence.hpp; else its (2) and (3), which take every excess for known

  [[nodiscard]] double power(const Power& left) const;
  [[nodiscard]] double weight(const Power& left) const;
};

/// −2 ln of the evidence, up to what all models of one problem share:
///
///   (1)  Σ_cb E_cb + Σ_causes 2 (−ln prior) + Σ_parameters (2 ln width − ln 2π) − ln|C|
///   (2)  C = (Jᵀ W J + diag(12/width²) of tolerated parameters)⁻¹,   W: weights w_cb of the residuals
///
/// E, w: Tempering. Priors and widths of effects stand on their cards (model/effects/effect.hpp). A parameter that is
/// fitted in every model counts with its bounds.
struct ModelEvidence {
  double left = 0.0;        ///< Σ E
  double causes = 0.0;      ///< by their priors
  double parameters = 0.0;  ///< Occam's factor of them
  [[nodiscard]] double total() const { return left + causes + parameters; }
};

/// `model`: at its minimum, with its Jacobian. `scales`: of the motion, in which widths of signed parameters are given.
[[nodiscard]] ModelEvidence evidence_of(const IdentificationProblem& problem, const CandidateModel& model,
                                        const Scales& scales, const Tempering& tempering);

/// √w of each residual of a fit, and the fit in units of these: linear algebra on it counts what is left as the
/// evidence does.
[[nodiscard]] Eigen::VectorXd roots_of_weights(const IdentificationProblem& problem, const Eigen::VectorXd& residual,
                                               const Tempering& tempering = {});
[[nodiscard]] Fit weighted(const Fit& fit, const Eigen::VectorXd& roots);

}  // namespace host_sim::identification
