// The roots of a delay equation right of a line: found, checked, and proven to be all.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/stability/delay_equation.hpp"

namespace host_sim::stability {

/// The roots found are not as many as the argument principle counts. It is never passed over in silence.
class CountMismatch : public std::logic_error {
 public:
  CountMismatch(int found, int proven, double line);
};

/// Roots with Im ≥ 0 right of a line, rightmost first; a multiple root stands there as often as it counts.
struct RootSet {
  std::vector<Complex> roots;  ///< [1/s]
  double line{};               ///< all roots right of Re s = `line` [1/s], which may lie right of the line asked for
  int count{};                 ///< number of roots right of the line, conjugates counted: the argument principle's
  double worst_residual{};     ///< max |f(s)| ÷ scale(s), in units of rounding 1 = 2.2e-16

  [[nodiscard]] Complex rightmost() const { return roots.front(); }
};

/// Newton from `start` to a root. False when it does not settle within 40 steps or leaves a residual beyond rounding.
[[nodiscard]] bool settle(const DelayEquation& equation, Complex& start);

/// Eigenvalues of the loop with its delay line discretised on `nodes` Chebyshev points (companion form of P, the
/// scalar Q/P-feedback in the line). Good to start from for |s| τ < 2 · nodes, no proof of anything.
/// Source: Breda, Maset, Vermiglio, Pseudospectral differencing methods for characteristic roots of delay differential
/// equations, SIAM J. Sci. Comput. 2005.
[[nodiscard]] std::vector<Complex> discretised_roots(const DelayEquation& equation, int nodes);

/// Finishes `starts` by Newton and keeps what lies right of `line`. Throws CountMismatch when these are not as many
/// roots as equation.roots_right_of(line).
[[nodiscard]] RootSet verified_roots(const DelayEquation& equation, double line, const std::vector<Complex>& starts);

/// How many roots a set may hold. A delay equation has ever more of them to the left: where there are more right of
/// the line that is asked for, the line moves right.
inline constexpr double most_roots = 60.0;

/// All roots right of Re s = `line` [1/s], and one at least: the line moves left until there is one.
[[nodiscard]] RootSet characteristic_roots(const DelayEquation& equation, double line);

}  // namespace host_sim::stability
