// Adaptive Metropolis: draws from a density that costs a simulation.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

namespace host_sim::transfer {

/// Logarithms of a density, up to one constant, at several points at once: the chains are stepped together, so that
/// their rigs share a simulation. −∞ where the density is 0.
using LogDensities = std::function<std::vector<double>(const std::vector<Eigen::VectorXd>&)>;

struct SamplerOptions {
  std::size_t draws = 10000;  ///< of all chains, those that adapt included
  std::uint64_t seed = 1;
  std::function<void(double share)> progress{};
};

/// Draws of all chains and what they say of themselves.
///
///   (1)  R̂ = √((W (n − 1)/n + B)/W)   W: mean of the variances in half chains of n draws, B: variance of their means
///   (2)  effective draws = m n/(1 + 2 Σ ρ_t)   ρ_t: autocorrelation over the chains, as far as sums of pairs fall
///
/// Sources: (1) A. Gelman et al., Bayesian Data Analysis, 3rd ed. 2013, 11.4, on half chains; (2) C. Geyer, Stat. Sci.
/// 7, 1992.
struct Samples {
  std::vector<Eigen::MatrixXd> chains;  ///< a column a draw, without those that adapted
  Eigen::VectorXd rhat, effective;      ///< of each coordinate
  double accepted = 0.0;                ///< share of the proposals

  [[nodiscard]] Eigen::MatrixXd all() const;  ///< the chains one after the other
};

[[nodiscard]] Eigen::VectorXd split_rhat(const std::vector<Eigen::MatrixXd>& chains);
[[nodiscard]] Eigen::VectorXd effective_draws(const std::vector<Eigen::MatrixXd>& chains);

/// Metropolis–Hastings with two proposals, one of them chosen for each step of each chain:
///
///   (3)  u′ = mode + L z √(5/χ²₅)             L Lᵀ = covariance: Student's t on the Laplace approximation, independent
///   (4)  u′ = u + (2.38/√d) L_a z              L_a L_aᵀ: covariance of all draws so far, as long as the chains adapt
///
/// thresholds::independent_share of them are (3), whose acceptance says how good the approximation is; (4) finds what
/// it misses. Chains begin at draws of (3). Outside of lower … upper the density is 0 and is not asked for. Source: H.
/// Haario, E. Saksman, J. Tamminen, Bernoulli 7, 2001; L. Tierney, Ann. Statist. 22, 1994.
[[nodiscard]] Samples sample(const LogDensities& log_densities, const Eigen::VectorXd& mode,
                             const Eigen::MatrixXd& covariance, const Eigen::VectorXd& lower,
                             const Eigen::VectorXd& upper, const SamplerOptions& options);

}  // namespace host_sim::transfer
