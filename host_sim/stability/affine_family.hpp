// A loop with a factor or a parameter in it that enters linearly, and the values that put roots on the axis.
#pragma once

#include <functional>
#include <vector>

#include "host_sim/stability/delay_equation.hpp"

namespace host_sim::stability {

/// g(x) = a(x) + b(x) cos τx + c(x) sin τx with real polynomials.
struct TrigonometricPolynomial {
  Polynomial a, b, c;
  double tau{};

  [[nodiscard]] double operator()(double x) const;
  [[nodiscard]] TrigonometricPolynomial derivative() const;
  /// At least max |g(x + t) − g(x)| over |t| ≤ r.
  [[nodiscard]] double variation(double x, double r) const;
};

/// All zeros in from … to, in order: intervals are halved until a bound of the variation proves that one holds no zero,
/// or that g grows or falls throughout. Zeros nearer to each other than 1e-9 of the range are reported as one.
[[nodiscard]] std::vector<double> zeros(const TrigonometricPolynomial& g, double from, double to);

/// Loops  f(s; κ) = P₀ + κ P₁ + (Q₀ + κ Q₁) e^{−sτ}.
struct AffineFamily {
  Polynomial p0, p1, q0, q1;

  [[nodiscard]] DelayEquation at(double kappa, double delay) const { return {p0 + kappa * p1, q0 + kappa * q1, delay}; }
};

/// The family of which member(κ) = {P, Q} is known at any κ; checked at a third value (std::logic_error if it is no
/// straight line).
struct LoopPolynomials {
  Polynomial p, q;
};
[[nodiscard]] AffineFamily affine_family(const std::function<LoopPolynomials(double)>& member, double typical);

/// No member with |κ| ≤ `size` has a root jω on the axis at or above this [rad/s], whatever the delay: there
/// |P₀|² > 3 (κ²|P₁|² + |Q₀|² + κ²|Q₁|²), so that |P₀| is more than all the rest together.
[[nodiscard]] double highest_frequency(const AffineFamily& family, double size);

/// A value of κ with a pair of roots ±jω on the axis.
struct AxisValue {
  double value{};
  double omega{};  ///< [rad/s]
  bool border{};   ///< no other root has Re > 0: the loop is stable on one side
};

/// All values in from … to with a root on the axis at ω > 0, by value.
///
/// f = f₀ + κ f₁ = 0 with real κ needs Im(f₀ f₁*) = 0 on the axis, a TrigonometricPolynomial of ω whose zeros are all
/// found below highest_frequency(); then κ = −Re(f₀/f₁).
[[nodiscard]] std::vector<AxisValue> axis_values(const AffineFamily& family, double delay, double from, double to);

}  // namespace host_sim::stability
