// Intervals of the parameters of a fit, and the combinations of parameters that the recordings leave open.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::identification {

/// The combinations of parameters that these channels and this excitation do not determine.
struct Undetermined {
  std::string combination;  ///< "body.mass, wheel.mass and all stiffnesses and dampings in one ratio"
  std::string why;          ///< "no force is measured"
  std::string cause{};      ///< of an effect or a fault of the recordings that has no name for that reason
};

/// The fitted windows are cut into blocks b of a second or two, each whitened by itself, with central differences:
///
///   (1)  g_b = J_bᵀ r_b,   A = Σ J_bᵀJ_b + diag(12/width²) of tolerated parameters
///   (2)  V_likelihood = A⁻¹ · χ²/n          noise is as declared, and what exceeds it is like noise
///   (3)  V_blocks = A⁻¹ (Σ (g_b − ḡ)(g_b − ḡ)ᵀ/spread) A⁻¹ · B/(B − 1)     whatever the residual is, as long as blocks
///   are independent
///   (4)  V_bands = Σ d_f d_fᵀ (F − 1)/F,   d_f = (A − A_f)⁻¹ g_f: how far the estimate moves without frequency band f,
///        where χ²/n says that the model is wrong
///   (5)  half width = max(1.96 √V_likelihood, t √V_blocks, t √V_bands) + s,  t: Student's, of as many blocks as count
///   (6)  s = |A⁻¹ Jᵀ (r with half of the steps − r)|: what the simulation's steps get wrong at corners
///
/// (3) is the sandwich of P. J. Huber, Proc. 5th Berkeley Symp., 1967, with the blocks of H. R. Künsch, Ann. Stat. 17,
/// 1989; (4) the jackknife, R. G. Miller, Biometrika 61, 1974. Residuals in bursts (friction, free play) and what one
/// frequency asks for against another widen it.
///
/// Where the tolerance says more than the data (A⁻¹ below half of the inverse without it) the estimate may lie anywhere
/// in what the tolerances allow, so the half width is 2√3 √A⁻¹, the width of a uniform distribution. A tolerated
/// parameter at its bound is known to its tolerance only.
///
/// Parameters without a tolerance are exact. Where no channel holds a force, nothing that is measured holds the unit of
/// mass, so that
///
///   (7)  every mass, stiffness, damping, force and density times 1 + ε     changes nothing, whatever ε
///
/// Where all of them are tolerated, their tolerances alone bound ε. Other null vectors of J, over what is fitted and in
/// relative changes, are said as well.
struct Uncertainty {
  /// The variance of a combination of coordinates by where it comes from. Its sum is that of (2), (3) or (4), whichever
  /// is largest; (3) and (4), of ν degrees of freedom, count where they are larger by 1.96 √(2/ν), their own relative
  /// deviation: within it they are the same number, known less well.
  struct VarianceParts {
    double noise = 0.0;          ///< of the sensors and of the input: what the tolerances leave of A⁻¹
    Eigen::VectorXd tolerances;  ///< A⁻¹ diag(12/width²) A⁻¹, one part for each coordinate; 0 without a tolerance
    double model = 0.0;          ///< beyond A⁻¹: the residual is more than the noise that is known
    [[nodiscard]] double sum() const { return noise + tolerances.sum() + model; }
  };
  [[nodiscard]] VarianceParts variance_parts(const Eigen::VectorXd& g) const;

  /// Widens the intervals by independent errors that noise does not hold (uncertainty_sources.hpp). `shifts`: how far
  /// one standard deviation of each moves the coordinates, a column each.
  ///
  ///   (8)  half width ← √((5)² + 1.96² Σ shift²)
  void add_shifts(const Eigen::MatrixXd& shifts);

  Eigen::VectorXd half_widths;  ///< 95 %, of the coordinates of fit.parameters; infinite: the whole tolerance
  std::vector<Undetermined> undetermined;

  /// (5) and (8) of gᵀu, any linear combination of the coordinates: a point of a curve that several of them move. Without what
  /// tolerances and bounds say about a single parameter.
  [[nodiscard]] double half_width_of(const Eigen::VectorXd& g) const;

  Eigen::MatrixXd covariance{};    ///< (2)
  Eigen::MatrixXd block_shares{};  ///< A⁻¹ (g_b − ḡ)/√spread, a column for each block; (3) is their sum
  std::vector<Eigen::MatrixXd> information{};  ///< A⁻¹ J_bᵀJ_b A⁻¹: which blocks count
  Eigen::MatrixXd band_shifts{};               ///< d_f of (4), a column for each band; none where (4) does not apply
  Eigen::VectorXd step_shift{};                ///< A⁻¹ Jᵀ (…) of (6), with its sign
  Eigen::MatrixXd inverse_information{};       ///< A⁻¹
  Eigen::VectorXd prior{};                     ///< the diagonal 12/width² of A
  Eigen::MatrixXd directions{};                ///< a column for each coordinate: without (7), where that is open
  Eigen::MatrixXd other_shifts{};              ///< of (8); empty: none
};
/// `every`: all parameters of the explained part (suspect_parameters()).
[[nodiscard]] Uncertainty uncertainty(const IdentificationProblem& problem, const std::vector<FreeParameter>& every,
                                      const Fit& fit);

/// Null vectors in words. `vectors`: columns, relative changes of the parameters with these names; a basis with few
/// entries is sought. `measures_force`: a channel holds a force.
[[nodiscard]] std::vector<Undetermined> in_words(const Eigen::MatrixXd& vectors, const std::vector<std::string>& names,
                                                 bool measures_force);

/// 97.5 % of Student's distribution. Source: expansion of R. A. Fisher and E. A. Cornish, Technometrics 2, 1960.
[[nodiscard]] double student(double degrees_of_freedom);

}  // namespace host_sim::identification
