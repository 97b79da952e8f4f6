// Elementary functions of a step, in + − × only: the same bits on every machine, and in every lane.
#pragma once

#include "model/numerics/select.hpp"

namespace model {

/// e^{−x} for x ≥ 0, 0 beyond x = 64 (e^{−64} = 2e-28).
///
///   e^{−x} = (Σ_{n ≤ 13} (−y)ⁿ/n!)^{2⁸},   y = x/2⁸ ≤ 1/4
///
/// The series is right to 1e-18; each squaring doubles its rounding error: 256 ε = 6e-14 relative at most.
template <class S>
[[nodiscard]] constexpr S decaying(S x) {
  constexpr int terms = 13, squarings = 8;
  const S y = select(x > S(64), S(0), x) * S(-1.0 / 256.0);
  S sum = S(1);
  for (int n = terms; n > 0; --n) sum = S(1) + sum * y * S(1.0 / n);
  for (int i = 0; i < squarings; ++i) sum = sum * sum;
  return select(x > S(64), S(0), sum);
}

/// sin(2π t) and cos(2π t) − 1.
template <class S>
struct Turn {
  S sine, cosine_less_one;
};

/// For |t| < 2³⁰ turns.
///
/// t less the nearest whole number; sine and cosine of a quarter of that angle, |y| ≤ π/4, by their series; then the
/// angle doubled twice, with c − 1 in place of c, which is small where the angle is. Error: 1e-15.
template <class S>
[[nodiscard]] constexpr Turn<S> turned(S t) {
  constexpr double to_whole = 6755399441055744.0;  // 1.5 · 2⁵²: adding it rounds to whole numbers
  constexpr double quarter = 1.5707963267948966;   // 2π/4
  const S y = (t - ((t + S(to_whole)) - S(to_whole))) * S(quarter), square = y * y;
  S s = S(1), c = S(1);
  for (int n = 8; n > 0; --n) {
    s = S(1) - s * square * S(1.0 / (2.0 * n * (2.0 * n + 1.0)));
    c = S(1) - c * square * S(1.0 / ((2.0 * n + 1.0) * (2.0 * n + 2.0)));
  }
  s = s * y;                 // sin y
  c = c * square * S(-0.5);  // cos y − 1
  for (int doubled = 0; doubled < 2; ++doubled) {
    const S sine = s;
    s = S(2) * sine * (S(1) + c);
    c = S(-2) * sine * sine;
  }
  return {s, c};
}

}  // namespace model
