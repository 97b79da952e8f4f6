// The posterior of the component: what the first rig's recordings say of what will travel.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/transfer/posterior/discrepancy.hpp"
#include "host_sim/transfer/posterior/sampler.hpp"

namespace host_sim::transfer {

/// One of the models that the recordings leave open, with draws of all of its parameters. Those that do not travel are
/// marginalised: their columns are there and nobody reads them.
///
///   (1)  posterior(u) ∝ exp(−χ²(u)/(2T)) on the box of the bounds, T = max(1, χ²/n at the optimum)
///   (2)  ln evidence = −χ²/(2T) + (d/2) ln 2π + ½ ln|C| − Σ ln width_i − ln prior odds      Laplace, at the optimum
///   (3)  u ← û + D (u − û),   D_i = half width_i/(1.96 σ_i) from thresholds::stretched_from on, else 1
///   (4)  u ← u + √V z                                                                      V: Discrepancy (2)
///   (5)  u ← u + Σ s_i z_i     where draws are used; s_i: what one standard deviation of a sensor's calibration moves
///                              (estimate/uncertainty_sources.hpp)
///
/// (3): half widths of estimate/uncertainty.hpp, which count residuals in bursts and bands that contradict each other;
/// only where residuals are more than noise or the rig has corners. Of white residuals the likelihood is right as it
/// is. It is the adjustment of B. Shaby, J. Am. Stat. Assoc. 109, 2014. χ² is that of the diagnosis. Sources: (2) R.
/// Kass and A. Raftery, J. Am. Stat. Assoc. 90, 1995.
struct ComponentModel {
  std::string name;  ///< "as diagnosed", "relaxation in the place of seal_friction"
  identification::Hypothesis hypothesis;
  std::vector<identification::FreeParameter> parameters;
  std::vector<firmware::PlacedEffect> effects;  ///< found, those that stay behind too
  Eigen::VectorXd mode;
  Eigen::MatrixXd covariance;     ///< Laplace with (3) and (4)
  Eigen::MatrixXd draws;          ///< a column a draw, without (5)
  Eigen::MatrixXd calibration{};  ///< s of (5), a column for each error of a sensor; empty: none
  double chi_squared = 0.0;
  double log_evidence = 0.0;
  double probability = 1.0;

  /// The hypothesis with these coordinates.
  [[nodiscard]] identification::Hypothesis at(const Eigen::VectorXd& u) const;
  /// (5), inside the bounds; `normal`: asked once for each column.
  [[nodiscard]] Eigen::VectorXd with_calibration(Eigen::VectorXd u, const std::function<double()>& normal) const;
};

/// A parameter, its value and 95 % interval, from the draws.
struct LearnedValue {
  std::string path;
  std::string unit;
  double value = 0.0, lower = 0.0, upper = 0.0;
  bool travels = false;
};

struct Posterior {
  std::vector<ComponentModel> models;  ///< the diagnosed one first
  Discrepancy discrepancy;             ///< of the diagnosed model
  std::vector<LearnedValue> learned;   ///< of the diagnosed model
  double temper = 1.0;                 ///< T
  std::size_t draws = 0;
  double largest_rhat = 1.0, fewest_effective = 0.0, accepted = 0.0;
  double confounded = 0.0;             ///< largest share of a component parameter's variance that (4) is
  std::vector<std::string> at_bounds;  ///< paths whose posterior lies at its bounds
  std::vector<std::string> warnings;   ///< of the sampler and the bounds

  [[nodiscard]] const ComponentModel& diagnosed() const { return models.front(); }
};

using TransferProgress = std::function<void(double share, const std::string& what)>;

/// Samples the diagnosed model with `draws` draws; its rivals are taken as Laplace has them.
[[nodiscard]] Posterior find_posterior(const firmware::RigDescription& from, const identification::Identified& first,
                                       std::size_t draws, std::uint64_t seed, const TransferProgress& progress = {});

/// A model of one structure, Laplace only: (2) and (3). Exposed for calibration.
[[nodiscard]] ComponentModel laplace_model(const identification::IdentificationProblem& problem,
                                           const identification::SearchSpace& space, identification::Fit fit,
                                           double temper);
/// Draws from the exact density (1), stretched by (3) and (4). Fills in draws; returns what the chains say.
struct ChainReport {
  double largest_rhat, fewest_effective, accepted, largest_ratio;
  std::string worst;  ///< parameter with the largest ratio of standard deviations
};
ChainReport sample_model(const identification::IdentificationProblem& problem, double temper,
                         const Discrepancy& discrepancy, const SamplerOptions& options, ComponentModel& model);

/// What is done where nobody thinks of the first rig's own effects: tolerated parameters of the component freed,
/// nothing else; the force is compared at the commanded deflection. The covariance scales with the residual, as a fit's
/// printout has it.
[[nodiscard]] ComponentModel naive_model(const firmware::RigDescription& from, const identification::Identified& first);

[[nodiscard]] std::string name_of(const identification::FreeParameter& parameter,
                                  const identification::Hypothesis& hypothesis);

}  // namespace host_sim::transfer
