// A free curve at a place, fitted by simulation error with a penalty on its bends.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "host_sim/identification/learn/excited_range.hpp"
#include "host_sim/identification/learn/law_fit.hpp"

namespace host_sim::identification {

/// The force F_i at its points x_i, F(0) = 0, as PenalisedFit finds it with
///
///   (1)  FᵀP F = Σ_i B_i²,   B_i = F_i − the straight line between its neighbours at x_i
///
/// which does not see straight lines. The points stand at ± s sinh(i a): the bends of a force over velocity are near 0
/// and samples far from it are few.
struct CurveFit {
  CandidateModel model;      ///< its last law is the curve
  Eigen::MatrixXd matrix;    ///< M of the F_i [1/N²], τ taken out
  Eigen::VectorXd gradient;  ///< of ½|r|² [1/N], τ taken out, everything else making way
  std::vector<double> at;    ///< x_i, without 0
  Eigen::VectorXd force;     ///< F_i
  double temper = 1.0;       ///< τ
  double freedom = 0.0;      ///< parameters that the curve is worth
  double gain = 0.0;         ///< fall of χ²

  /// χ² of another curve at these points, less that of this one, while all else makes way linearly.
  [[nodiscard]] double farther(const Eigen::VectorXd& other) const {
    const Eigen::VectorXd d = other - force;
    return d.dot(matrix * d) + 2.0 * gradient.dot(d);
  }
};

/// A curve that is flat, over the range.
[[nodiscard]] PlacedLaw flat_curve(CurvePlace place, CurveOver over, const ExcitedRange& range);

/// Fits it from `start`, whose last law is a curve of points. nullopt: no simulation stays finite.
[[nodiscard]] std::optional<CurveFit> fit_curve(const IdentificationProblem& problem, const SearchSpace& space,
                                                const Hypothesis& start,
                                                const std::vector<firmware::PlacedEffect>& effects, int most);

}  // namespace host_sim::identification
