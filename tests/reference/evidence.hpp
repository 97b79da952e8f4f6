// Equations (2) to (6): what a residual counts, the evidence for a model, and what follows from it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace reference {

/// The bands [Hz] of the error model: narrow where modes are, wide enough above for many independent bins.
inline constexpr std::array<double, 14> band_edges{0, 0.5, 1, 2, 3, 4.5, 6.5, 9, 13, 18, 26, 40, 60, 90};
inline constexpr std::size_t bands = band_edges.size() - 1;
inline constexpr double directions = 4.0;  ///< K of a channel in a band: a smooth complex response error has two values

/// Power of the whitened residuals of one channel in one band, a cell.
struct Cell {
  double power = 0.0;  ///< P = Σ r²
  double count = 0.0;  ///< ν, of which P is χ² where only noise is left
};

/// (2)  E = P where P ≤ ν,  else ν + K ln(1 + x/K),   x = P − ν
[[nodiscard]] double counted(const Cell& cell);
/// (3)  w = dE/dP = 1/(1 + x/K), 1 below the noise
[[nodiscard]] double weight(const Cell& cell);

/// The uncertain terms of (4): Σ (2 ln width − ln 2π) − ln|C|, C = (H + diag(12/width²))⁻¹, H = Jᵀ W J.
[[nodiscard]] double occam(const Eigen::MatrixXd& hessian, const std::vector<double>& widths);

/// (5) for one model: the probability that a discrepancy is in any cell, 1 − Π 1/(1 + r). In which K of the ν directions it
/// lies nobody knows, so its power alone tells, z standard deviations out (E. B. Wilson, M. M. Hilferty, PNAS 17, 1931):
///
///   (5a)  z = ((P/ν)^⅓ − 1 + q)/√q,   q = 2/9ν
///   (5b)  r = c/(1 − c) · √(2π) exp(z²/2)/(z ln 10¹⁰)      z ≥ 1; any order of magnitude of ten is alike before
///
/// c: chance of a discrepancy in a cell, of all cells together `outside`.
[[nodiscard]] double unexplained(const std::vector<Cell>& cells, double outside);

/// p(M | y) of models whose −2 ln p(y, M) are given: exp(−½ v)/Σ; 0 beyond 1000 : 1 of the best.
[[nodiscard]] std::vector<double> posterior(const std::vector<double>& minus_two_ln);

}  // namespace reference
