// What even the best model of the component leaves unexplained, as a band-limited process.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::transfer {

/// The component's real force is its model's times 1 + δ(f), δ a complex number for each band: M. Kennedy and A.
/// O'Hagan, J. R. Stat. Soc. B 63, 2001, with a process that is independent from band to band instead of smooth over
/// the inputs.
///
///   (1)  E|δ_b|² = Σ_{f∈b} S_e(f) (ρ_b − 1)/ρ_b ÷ Σ_{f∈b} S_F(f)        S_e: of the residual, S_F: of the force,
///                                                                        ρ_b: whitened power per residual
///
/// in bands where ρ_b is above 1 by thresholds::discrepancy_significance; elsewhere δ_b = 0.
///
/// Confounding. The part of a discrepancy that a change of the parameters would make, too, is no longer in the
/// residual: the fit has taken it. It is not told apart by data. So the parameters are widened by what a discrepancy of
/// the size found in each band, with any phase, would have moved them:
///
///   (2)  V = Σ_b ½ Σ_{φ=0,90°} d dᵀ,   d = A⁻¹ Jᵀ s_b(φ),   s_b(φ): whitened δ_b F e^{iφ}
///
/// and the report says how much of the parameters' variance that is.
struct Discrepancy {
  struct InBand {
    double lowest, highest;  ///< [Hz]
    double relative;         ///< √E|δ_b|², 1
    double significance;     ///< [standard deviations]
  };
  std::vector<InBand> bands{};  ///< all bands with residuals, in order
  Eigen::MatrixXd widening{};   ///< (2), of the coordinates of the fit
  model::Channel channel{};     ///< that stands for the force
  bool measured = false;        ///< a channel for the force was measured

  [[nodiscard]] bool any() const;
  [[nodiscard]] double relative_at(double frequency) const;
};
[[nodiscard]] Discrepancy find_discrepancy(const identification::IdentificationProblem& problem,
                                           const identification::Fit& fit, const Eigen::MatrixXd& covariance);

}  // namespace host_sim::transfer
