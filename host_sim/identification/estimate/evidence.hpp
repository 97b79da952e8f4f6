// The evidence for a model beside which a discrepancy may be left.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host_sim/identification/common/frequency_bands.hpp"

namespace host_sim::identification {

/// The error model. What a model leaves of channel c in band b is P = Σ|r|² of ν residuals whitened by the known noise.
/// Noise of variance 1 is in all of them; a discrepancy, a reproducible function of the motion, is in K directions that
/// nobody knows, with the variance s relative to noise:
///
///   (1)  −2 ln p(r | s) = (P − x) + K ln(1 + s) + (K + x)/(1 + s) − K,    x = max(P − ν, 0)
///
/// Its least value, at s = x/K, and how fast that grows with P:
///
///   (2)  E = P                          where P ≤ ν
///        E = ν + K ln(1 + x/K)          else
///   (3)  w = dE/dP = 1/(1 + x/K)
///
/// E is χ² at the noise and K ln χ² far above it: there an effect must explain a share, band by band.
///
/// (2) takes every excess for a discrepancy, also that of √(2ν) which noise alone has. Where the K directions lie nobody
/// knows, so what says that there is a discrepancy is the power alone. z is how far it is out, in standard deviations,
/// and r the odds that something is there, of any order of magnitude alike (over W = ln(largest/least)):
///
///   (4)  z = ((P/ν)^⅓ − 1 + 2/9ν) / √(2/9ν) ÷ √(1 + ε²ν/2)         ε: relative error of the noise's variance
///   (5)  r = c/(1 − c) · √(2π) exp(z²/2)/(z W),   z ≥ 1               c: chance before anything is seen
///   (6)  w = (1 + r/(1 + x/K))/(1 + r),   E = P below ν, else ν + ∫_ν^P w dP'
///
/// (5): ∫ N(x; a, σ²) da/(a W) ÷ N(x; 0, σ²). Far above the noise (6) is (2) and (3). Sources: (1) a Gaussian process of
/// few directions, M. Kennedy and A. O'Hagan, J. R. Stat. Soc. B 63, 2001; (4) E. B. Wilson and M. M. Hilferty, The
/// distribution of chi-square, PNAS 17, 1931.
struct DiscrepancyModel {
  double directions = 4.0;            ///< K
  double chance = 0.05;               ///< c, of a channel in a band
  double orders_of_magnitude = 10.0;  ///< W/ln 10
  double noise_error = 0.0;           ///< ε
};

/// (2)
[[nodiscard]] double tempered_power(const Power& left, double directions);
/// (3)
[[nodiscard]] double tempered_weight(const Power& left, double directions);
/// (6): weight and tempered power where a discrepancy is known by the power alone.
[[nodiscard]] double weight_of(const Power& left, const DiscrepancyModel& discrepancy);
[[nodiscard]] double tempered_power(const Power& left, const DiscrepancyModel& discrepancy);

/// The probability that more than noise is left in a band: r/(1 + r).
[[nodiscard]] double chance_of_discrepancy(const Power& left, const DiscrepancyModel& discrepancy);
/// 1 − Π (1 − p): that it is left in any of them
[[nodiscard]] double chance_of_discrepancy(const std::vector<Power>& left, const DiscrepancyModel& discrepancy);

/// Occam's factor of parameters whose values are spread over `widths` before the recordings are seen and have the
/// covariance C after, both in coordinates u:
///
///   (7)  Σ (2 ln width − ln 2π) − ln|C|
///
/// Laplace's approximation of −2 ln ∫ p(y | u)/width du, less its value at the maximum. Source: R. Kass and A. Raftery,
/// Bayes factors, J. Am. Stat. Assoc. 90, 1995. A parameter that the data do not narrow costs nothing: each interval
/// counts as no wider than its width.
[[nodiscard]] double occam_factor(const std::vector<double>& widths, const Eigen::MatrixXd& covariance);

/// ln of the probability of what each of several models leaves, normalised: exp(−½ v_i)/Σ exp(−½ v_j).
[[nodiscard]] std::vector<double> posterior_of(const std::vector<double>& minus_two_ln_evidence);

}  // namespace host_sim::identification
