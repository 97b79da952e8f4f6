// What a change of the residuals gains while everything fitted already makes way linearly.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::identification {

/// With r the residuals of a fit, J its Jacobian and d the change of r that a candidate makes,
///
///   (1)  gain = max over s ∈ [0, 2] of  |r|² − min_θ |r + s d + J θ|²      of a candidate: s = 1 is its start
///   (2)  the same over all s                                               of a parameter, whose d is a derivative
///
/// Parameters at a bound cannot make way. Source: the Lagrange multiplier (score) test, C. R. Rao, Proc. Camb. Phil.
/// Soc. 44, 1948. The fit must outlive this.
class LinearRefit {
 public:
  explicit LinearRefit(const Fit& base);

  [[nodiscard]] double gain(const Eigen::VectorXd& d) const;       ///< (1)
  [[nodiscard]] double free_gain(const Eigen::VectorXd& d) const;  ///< (2); 0 where the others do all that d does

  /// Of several directions together, the columns of D, behind everything else: with P the projection on what J leaves,
  ///
  ///   (3)  matrix = Dᵀ P D,   gradient = Dᵀ P r;   the best step is −matrix⁻¹ gradient
  struct Directions {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
  };
  [[nodiscard]] Directions directions(const Eigen::MatrixXd& d) const;

  /// The best step of (3), of directions to which the change is proportional; 0 of those in which the others make all
  /// the way.
  [[nodiscard]] Eigen::VectorXd best_sizes(const Eigen::MatrixXd& d) const;

 private:
  /// |d|² and r·d of what the others leave of d.
  struct Left {
    double square, along;
  };
  [[nodiscard]] Left left(const Eigen::VectorXd& d) const;

  const Fit& base_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd residual_;
};

}  // namespace host_sim::identification
