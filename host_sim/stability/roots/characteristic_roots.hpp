// All roots of a delay equation right of a line, with a proof of their number.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/stability/roots/delay_equation.hpp"

namespace host_sim::stability {

/// The number of roots found differs from the count of the argument principle. This is always an error.
class CountMismatch : public std::logic_error {
 public:
  CountMismatch(int found, int proven, double line);
};

/// Roots with Im ≥ 0 right of a line, rightmost first; a multiple root is listed with its multiplicity.
struct RootSet {
  std::vector<Complex> roots;  ///< [1/s]
  double line{};            ///< the set holds all roots with Re s > `line` [1/s]; may lie right of the requested line
  int count{};              ///< number of roots right of the line, conjugates included, by the argument principle
  double worst_residual{};  ///< max |f(s)| ÷ scale(s), in units of rounding 1 = 2.2e-16

  [[nodiscard]] Complex rightmost() const { return roots.front(); }
};

/// Newton iteration from `start` to a root. False if it does not converge within 40 steps or leaves a residual above
/// rounding.
[[nodiscard]] bool settle(const DelayEquation& equation, Complex& start);

/// Eigenvalues of the loop with its delay line discretised on `nodes` Chebyshev points (companion form of P, the
/// scalar Q/P-feedback in the line). These are start values for |s| τ < 2 · nodes, without proof.
/// Source: Breda, Maset, Vermiglio, Pseudospectral differencing methods for characteristic roots of delay differential
/// equations, SIAM J. Sci. Comput. 2005.
[[nodiscard]] std::vector<Complex> discretised_roots(const DelayEquation& equation, int nodes);

/// Refines `starts` by Newton and keeps the roots right of `line`. Throws CountMismatch if their number is not
/// equation.roots_right_of(line).
[[nodiscard]] RootSet verified_roots(const DelayEquation& equation, double line, const std::vector<Complex>& starts);

/// Largest number of roots in a set [1]. A delay equation has infinitely many roots to the left; if more than this
/// number lie right of the requested line, the line moves right. Chosen so that a report stays readable.
inline constexpr double most_roots = 60.0;

/// All roots right of Re s = `line` [1/s]. If there is none, the line moves left until there is one.
[[nodiscard]] RootSet characteristic_roots(const DelayEquation& equation, double line);

}  // namespace host_sim::stability
