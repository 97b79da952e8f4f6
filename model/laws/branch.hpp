// A branch with memory.
#pragma once

#include <limits>

#include "model/exact_discretisation.hpp"
#include "model/inline.hpp"
#include "model/laws/law_tables.hpp"

namespace model {

/// A spring in series with a dashpot or with a dry slider, u its force:
///
///   (1)  u̇ = k ẋ − u/T                          Maxwell branch
///   (2)  u = clamp(u + k Δx, ±s)                 elastic slider (Jenkins element): Δx of a step in one direction
///
/// A step of (1) is exact for a deflection that goes straight through it: u₁ = E u₀ + k (T/h)(1 − E) Δx, E = e^{−h/T}.
/// (2) is the closed form of the slider's law (return mapping): exact for every Δx in one direction. Both are bounded
/// for every stiffness: |∂u₁/∂x₁| ≤ k, and what they store is never negative. Several sliders beside each other make an
/// Iwan (Prandtl–Ishlinskii) stack. Source: Simo and Hughes, Computational Inelasticity, 1998, 1.4.
template <class S>
class Branch {
 public:
  Branch() = default;
  Branch(const BranchNumbers<S>& numbers, S period) : stiffness_(numbers.stiffness), slip_(numbers.slip_force) {
    if (!(numbers.time_constant > S(0))) return;
    const ExactDiscretisation<S, 1> exact(Block<S, 1, 1>(S(-1) / numbers.time_constant), period);
    kept_ = exact.transition()(0);
    stiffness_ *= exact.held(Column<S, 1>(S(1)))(0) / period;  // (T/h)(1 − E), without cancellation for h ≪ T
    slip_ = std::numeric_limits<S>::max();
  }

  /// u at the end of a step in which the deflection changes by `travel`.
  [[nodiscard]] RIGTWIN_INLINE S after(S u, S travel) const {
    const S force = kept_ * u + stiffness_ * travel;
    return select(force > slip_, slip_, select(force < -slip_, S(-slip_), force));
  }
  /// The most that u changes by a unit of travel.
  [[nodiscard]] RIGTWIN_INLINE S stiffness() const { return stiffness_; }
  /// Without travel.
  [[nodiscard]] RIGTWIN_INLINE S kept(S u) const { return kept_ * u; }

 private:
  S kept_{1};      ///< E
  S stiffness_{};  ///< k (T/h)(1 − E)
  S slip_{};       ///< s
};

}  // namespace model
