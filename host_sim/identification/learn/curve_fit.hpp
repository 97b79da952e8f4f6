// A free curve at a place, fitted by simulation error with a penalty on its bends.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "host_sim/identification/learn/excited_range.hpp"
#include "host_sim/identification/learn/law_fit.hpp"

namespace host_sim::identification {

/// With F_i the curve at its points x_i, F(0) = 0, and θ everything else that is free,
///
///   (1)  min over F, θ of  |r(F, θ)|²/τ + λ Σ_i B_i²         τ = max(1, χ²/n)
///   (2)  B_i = F_i − the straight line between its neighbours at x_i
///   (3)  λ = argmax of  −½ min (1) + ½ (K − 1) ln λ − ½ ln |M/τ + λ P|      marginal likelihood, linearised
///
/// r: whitened residuals; K points that are free; M: matrix of LinearRefit (3) of the F_i; P = BᵀB. The points stand
/// at ± s sinh(i a): the bends of a force over velocity are near 0 and samples far from it are few. Sources: D. J. C.
/// MacKay, Bayesian interpolation, Neural Computation 4, 1992; P. H. C. Eilers and B. D. Marx, Statistical Science 11,
/// 1996.
struct CurveFit {
  CandidateModel model;      ///< its last law is the curve
  Eigen::MatrixXd matrix;    ///< M of the F_i [1/N²], τ taken out
  Eigen::VectorXd gradient;  ///< of ½|r|² [1/N], τ taken out, everything else making way
  std::vector<double> at;    ///< x_i, without 0
  Eigen::VectorXd force;     ///< F_i
  double temper = 1.0;       ///< τ
  double freedom = 0.0;      ///< parameters that the curve is worth: trace of (M/τ + λP)⁻¹ M/τ
  double gain = 0.0;         ///< fall of χ²

  /// χ² of another curve at these points, less that of this one, while all else makes way linearly.
  [[nodiscard]] double farther(const Eigen::VectorXd& other) const {
    const Eigen::VectorXd d = other - force;
    return d.dot(matrix * d) + 2.0 * gradient.dot(d);
  }
};

/// A curve that is flat, over the range.
[[nodiscard]] PlacedLaw flat_curve(CurvePlace place, CurveOver over, const ExcitedRange& range);

/// Fits (1) from `start`, whose last law is a curve of points. nullopt: no simulation stays finite.
[[nodiscard]] std::optional<CurveFit> fit_curve(const IdentificationProblem& problem, const SearchSpace& space,
                                                const Hypothesis& start,
                                                const std::vector<firmware::PlacedEffect>& effects, int most);

}  // namespace host_sim::identification
