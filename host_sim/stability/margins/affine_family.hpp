// Loops with one parameter that enters linearly, and the parameter values that put roots on the imaginary axis.
#pragma once

#include <functional>
#include <vector>

#include "host_sim/stability/roots/delay_equation.hpp"

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

/// All zeros between `from` and `to`, ascending. Intervals are halved until a bound of the variation proves that an
/// interval holds no zero or that g is monotonic in it. Zeros closer together than 1e-9 of the range are reported as
/// one.
[[nodiscard]] std::vector<double> zeros(const TrigonometricPolynomial& g, double from, double to);

/// Loops  f(s; κ) = P₀ + κ P₁ + (Q₀ + κ Q₁) e^{−sτ}.
struct AffineFamily {
  Polynomial p0, p1, q0, q1;

  [[nodiscard]] DelayEquation at(double kappa, double delay) const { return {p0 + kappa * p1, q0 + kappa * q1, delay}; }
};

/// The family that passes through member(κ) = {P, Q} at two values of κ. A third value checks that P and Q are linear
/// in κ (std::logic_error if not).
struct LoopPolynomials {
  Polynomial p, q;
};
[[nodiscard]] AffineFamily affine_family(const std::function<LoopPolynomials(double)>& member, double typical);

/// Frequency [rad/s] at and above which no member with |κ| ≤ `size` has a root jω on the axis, at any delay: there
/// |P₀|² > 3 (κ²|P₁|² + |Q₀|² + κ²|Q₁|²), hence |P₀| exceeds the sum of all other terms.
[[nodiscard]] double highest_frequency(const AffineFamily& family, double size);

/// A value of κ with a pair of roots ±jω on the axis.
struct AxisValue {
  double value{};
  double omega{};  ///< [rad/s]
  bool border{};   ///< no other root has Re > 0, so the loop is stable on one side
};

/// All values in from … to with a root on the axis at ω > 0, by value.
///
/// f = f₀ + κ f₁ = 0 with real κ needs Im(f₀ f₁*) = 0 on the axis, a TrigonometricPolynomial of ω whose zeros are all
/// found below highest_frequency(); then κ = −Re(f₀/f₁).
[[nodiscard]] std::vector<AxisValue> axis_values(const AffineFamily& family, double delay, double from, double to);

}  // namespace host_sim::stability
