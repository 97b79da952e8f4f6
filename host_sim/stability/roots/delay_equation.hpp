// Characteristic equation of a loop with one delay, and the number of its roots right of a line, with proof.
#pragma once

#include <stdexcept>
#include <string>

#include "host_sim/stability/roots/polynomial.hpp"

namespace host_sim::stability {

/// The equations here do not apply to this loop; what() gives the reason.
class UnfitLoop : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A root lies so close to the line that rounding decides its side.
class RootOnLine : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Retarded characteristic equation
///
///   (1)  f(s) = P(s) + Q(s) e^{−sτ} = 0,   deg Q < deg P,   τ ≥ 0 [s]
///
/// With deg Q = deg P the equation is neutral: the highest derivative itself is delayed, as by a mass between force
/// sensor and component (F = … + m ẍ_act); its roots run to infinity along Re s = ln|q/p|/τ and, for |q| ≥ |p|, no
/// delay however small is stable. Such a loop, and an advanced one (deg Q > deg P), is refused.
class DelayEquation {
 public:
  DelayEquation(Polynomial p, Polynomial q, double delay);  ///< Throws UnfitLoop unless (1) is retarded.

  [[nodiscard]] const Polynomial& p() const { return p_; }
  [[nodiscard]] const Polynomial& q() const { return q_; }
  [[nodiscard]] double delay() const { return delay_; }
  void set_delay(double delay) { delay_ = delay; }  ///< [s] >= 0

  [[nodiscard]] Complex operator()(Complex s) const { return p_(s) + times(q_(s), delayed(s)); }
  /// f and df/ds.
  [[nodiscard]] std::array<Complex, 2> jet(Complex s) const;
  /// ∂f/∂τ
  [[nodiscard]] Complex by_delay(Complex s) const { return -times(s, times(q_(s), delayed(s))); }
  /// Sum of the absolute values of the terms of f at s: the rounding error of f is about 1e-16 of it.
  [[nodiscard]] double scale(Complex s) const;
  /// e^{−sτ}
  [[nodiscard]] Complex delayed(Complex s) const;

  /// Upper bound [1/s] of the modulus of roots with Re s ≥ `line`: beyond it |P| > |Q e^{−sτ}|.
  [[nodiscard]] double radius(double line) const;

  /// Number of roots, with their multiplicities, right of Re s = `line` [1/s].
  ///
  /// Argument principle on the line and on the arc of `radius` around its right side. The line is divided into steps
  /// t = 0 … r on which f(s + jt) = (f₀ + f₁ jt)(1 + ε) with |ε| < 1 is proven by the Taylor remainder
  ///
  ///   (2)  Σ_{k≥2} |p_k| r^k + |e^{−sτ}| (|q₀| (rτ)²/2 + |q₁| r·rτ + Σ_{k≥2} |q_k| r^k) < min_t |f₀ + f₁ jt|
  ///
  /// so that no turn of the phase can be missed. On the arc f = s^n (1 + ε) with |ε| < 1 because of the radius. The sum
  /// of the phases must be a whole number of turns. Throws RootOnLine.
  [[nodiscard]] int roots_right_of(double line) const;

 private:
  Polynomial p_, q_;
  double delay_;
};

}  // namespace host_sim::stability
