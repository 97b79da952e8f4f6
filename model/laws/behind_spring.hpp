// A curve behind a spring.
#pragma once

#include "model/laws/curve.hpp"
#include "model/laws/law_tables.hpp"
#include "model/numerics/inline.hpp"

namespace model {

/// A curve f in series with a spring of stiffness k. Both carry one force u; x is the deflection of both together, x_i
/// that of the curve, which has no mass:
///
///   (1)  u = k (x − x_i) = f(x_i)                          a curve over the deflection: no memory
///   (2)  u̇ = k (ẋ − v_i),   u = f(v_i)                     a curve over the velocity
///
/// f nowhere falls, so that (3) has one solution v for every y (Curve::where):
///
///   (3)  f(v) + κ v = y                                    (1): κ = k, y = k x, u = f(x_i)
///   (4)  f(v_a) + γhk v_a = u₀ + γ k Δx                        a step of (2), in which x goes straight by Δx,
///        f(v₁) + γhk v₁ = u₀ + k Δx − (1 − γ) hk v_a           γ = 1 − 1/√2,   u₁ = f(v₁)
///
/// (4) is of second order and L-stable: a damper as steep as dry friction neither rings nor is overshot.
/// 0 ≤ ∂u₁/∂Δx ≤ k. Source: R. Alexander, Diagonally implicit Runge–Kutta methods for stiff ODEs, SIAM J. Numer. Anal.
/// 1977; (2) is Maxwell's branch with a dashpot that is no straight line.
template <class S>
class BehindSpring {
 public:
  BehindSpring() = default;
  BehindSpring(S stiffness, LawOver over, S period)
      : stiffness_(stiffness),
        through_step_(stiffness * period),
        implicit_(over == LawOver::velocity ? S(S(gamma) * through_step_) : stiffness) {}

  [[nodiscard]] S stiffness() const { return stiffness_; }
  /// (1)
  [[nodiscard]] S at(const Curve<S>& curve, S deflection) const {
    const S y = stiffness_ * deflection;
    return y - implicit_ * curve.where(y, implicit_);
  }
  /// (4): u₁
  [[nodiscard]] S after(const Curve<S>& curve, S force, S travel) const {
    const S pushed = stiffness_ * travel;
    const S first = curve.where(force + S(gamma) * pushed, implicit_);
    const S y = force + pushed - S(1 - gamma) * through_step_ * first;
    return y - implicit_ * curve.where(y, implicit_);
  }

 private:
  static constexpr double gamma = 0.29289321881345248;  ///< 1 − 1/√2

  S stiffness_{};     ///< k
  S through_step_{};  ///< h k
  S implicit_{};      ///< κ
};

}  // namespace model
