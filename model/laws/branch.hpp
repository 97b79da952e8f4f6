// A branch with memory.
#pragma once

#include "model/laws/law_tables.hpp"
#include "model/numerics/exact_discretisation.hpp"
#include "model/numerics/inline.hpp"

namespace model {

/// A spring in series with a dashpot or with a dry slider, u its force:
///
///   (1)  u̇ = k ẋ − u/T                          Maxwell branch
///   (2)  u = clamp(u + k Δx, ±s)                 elastic slider (Jenkins element): Δx of a step in one direction
///   (3)  w = clamp(w + k Δx, ±(s + k g/2)),      slider with free play g in series: w/k is the stretch of spring and
///        u = w − clamp(w, ±k g/2)                play, whose force sets in when the play is used up
///
/// A step of (1) is exact for a deflection that goes straight through it: u₁ = E u₀ + k (T/h)(1 − E) Δx, E = e^{−h/T}.
/// (2) and (3) are closed forms of the slider's law (return mapping): exact for every Δx in one direction. All are
/// bounded for every stiffness: |∂u₁/∂x₁| ≤ k, and what they store is never negative. What a branch remembers is w;
/// with g = 0, and of (1), it is the force. Several sliders beside each other make an Iwan (Prandtl–Ishlinskii) stack.
/// Source: Simo and Hughes, Computational Inelasticity, 1998, 1.4.
template <class S>
class Branch {
 public:
  Branch() = default;
  Branch(const BranchNumbers<S>& numbers, S period)
      : stiffness_(numbers.stiffness),
        play_(S(0.5) * numbers.gap * numbers.stiffness),
        slip_(numbers.slip_force + play_) {
    if (!same(numbers.time_constant > S(0))) return;
    const ExactDiscretisation<S, 1> exact(Block<S, 1, 1>(S(-1) / numbers.time_constant), period);
    kept_ = exact.transition()(0);
    stiffness_ *= exact.held(Column<S, 1>(S(1)))(0) / period;  // (T/h)(1 − E), without cancellation for h ≪ T
    play_ = S(0);
    slip_ = largest_number<S>();
  }

  /// w at the end of a step in which the deflection changes by `travel`.
  [[nodiscard]] RIGTWIN_INLINE S after(S w, S travel) const { return within(kept_ * w + stiffness_ * travel, slip_); }
  /// u
  [[nodiscard]] RIGTWIN_INLINE S force(S w) const { return w - within(w, play_); }
  /// The most that u changes by a unit of travel.
  [[nodiscard]] RIGTWIN_INLINE S stiffness() const { return stiffness_; }
  /// w without travel.
  [[nodiscard]] RIGTWIN_INLINE S kept(S w) const { return kept_ * w; }

 private:
  [[nodiscard]] RIGTWIN_INLINE static S within(S value, S limit) {
    return select(value > limit, limit, select(value < -limit, S(-limit), value));
  }

  S kept_{1};      ///< E
  S stiffness_{};  ///< k (T/h)(1 − E)
  S play_{};       ///< k g/2
  S slip_{};       ///< s + k g/2
};

}  // namespace model
