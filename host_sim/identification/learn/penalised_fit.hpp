// A fit by simulation error whose last law is held smooth, by as much as the data ask for.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host_sim/identification/learn/law_fit.hpp"

namespace host_sim::identification {

/// χ² as a quadratic function of the K free values F of a law, with all other parameters at their best for each F:
///
///   (1)  χ²/2 = const + gᵀd + ½ dᵀM d,   d: a change of F
///
/// in the coordinates of FreeParameter. τ = max(1, χ²/n); λ: weight of the penalty FᵀP F.
struct LawInformation {
  Eigen::MatrixXd matrix;    ///< M
  Eigen::VectorXd gradient;  ///< g
  Eigen::VectorXd now;       ///< F
  Eigen::MatrixXd penalty;   ///< P
  double scale = 1.0;        ///< unit of F [N]
  double temper = 1.0;       ///< τ
  double lambda = 1.0;       ///< λ

  /// Parameters that F is worth: trace of (M/τ + λP)⁻¹ M/τ.
  [[nodiscard]] double freedom() const;
};

/// F of the last law of `start`, and θ, everything else that is free:
///
///   (2)  min over F, θ of  |r(F, θ)|²/τ + λ FᵀP F
///   (3)  λ = argmax of  −½ min (2) + ½ rank(P) ln λ − ½ ln |M/τ + λP|      marginal likelihood, linearised
///
/// by Gauss–Newton, λ found anew in each step. r: whitened residuals. Sources: D. J. C. MacKay, Bayesian interpolation,
/// Neural Computation 4, 1992; P. H. C. Eilers and B. D. Marx, Statistical Science 11, 1996.
class PenalisedFit {
 public:
  /// `straight`: how many dimensions P does not see.
  PenalisedFit(const IdentificationProblem& problem, const SearchSpace& space, const Hypothesis& start,
               const std::vector<firmware::PlacedEffect>& effects, Eigen::MatrixXd penalty, Eigen::Index straight);

  /// False: the simulation does not stay finite.
  [[nodiscard]] bool is_finite() const;
  /// As many steps as pay, `most` at most.
  void run(int most);
  [[nodiscard]] const LawInformation& known() const { return known_; }
  [[nodiscard]] double gain() const { return before_ - fit_.chi_squared; }  ///< fall of χ²
  [[nodiscard]] CandidateModel model() const;

 private:
  bool step();
  void linearise();
  void reduce();

  const IdentificationProblem& problem_;
  const std::vector<firmware::PlacedEffect>& effects_;
  Fit fit_;
  Eigen::Index first_ = 0, count_ = 0;  ///< of the law's values among the free parameters
  Eigen::Index straight_;
  double before_ = 0.0;
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
  LawInformation known_;
};

/// The matrix that takes the values at x_i to the distance of each inner value from the straight line between its two
/// neighbours.
[[nodiscard]] Eigen::MatrixXd bends(const std::vector<double>& at);

}  // namespace host_sim::identification
