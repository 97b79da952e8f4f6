// The laws of a rig in steps.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "model/inline.hpp"
#include "model/laws/branch.hpp"
#include "model/laws/curve.hpp"
#include "model/laws/surface.hpp"
#include "model/motion.hpp"

namespace model {

/// The forces of all laws at their places.
///
/// During a step the force of a place goes straight from f₀ + w Δ to f₁ = f₀ + Δ; f₀ is its value at the start. f₁ is
/// taken at the motion that the step reaches under this very force:
///
///   (1)  x₁ = x_free + (r + w (q − r)) Δ         x_free: end of the step with f₀ held; by a unit of Δ: r if it grows
///                                                through the step, q if it is held; ẋ₁ alike
///   (2)  Δ = Δ_free / (1 + κ_r + w (κ_q − κ_r))  Δ_free = f(x_free) − f₀,  κ = −Σ c r,  c: chord of each law from x₀
///                                                to x_free
///   (3)  w = κ_r²/(1 + κ_r²)
///
/// (2) solves f(x₁) = f₁ with the law replaced by its chord. For a law whose force grows with its variable the solution
/// lies between 0 and Δ_free, so a step cannot overshoot, however steep the law is. On a linear law (1) to (3) are a
/// θ-method with θ = (1 + w)/2 ≥ ½ over the velocity, Newmark's method with γ = (1 + w)/2, β = 1/6 + w/3 over the
/// deflection: stable for every slope, because 12/(1 − w) > (ωh)² always. w is of the order h² at least, so the step is
/// of second order; multistep rules of higher order are not stable for every slope (Dahlquist, BIT 1963). The force at
/// the end of a step is the law's own value at the motion that was reached, not f₁. A falling law counts with c = 0:
/// explicit.
template <class S, LawCapacity capacity>
class PlacedLaws {
 public:
  static constexpr bool possible = capacity.any();

  struct State {
    std::array<S, force_places> force{};       ///< f at this instant [N]
    std::array<Stroke<S>, force_places> at{};  ///< the motion that it belongs to
    std::array<S, capacity.curves> curves{};
    std::array<S, capacity.surfaces> surfaces{};
    std::array<S, capacity.branches> branches{};  ///< u
  };

  PlacedLaws() = default;
  PlacedLaws(const Laws<S, capacity>& laws, S period) {
    for (std::size_t i = 0; i < laws.curve_count; ++i) {
      const CurveTable<S>& table = laws.curves[i];
      curves_[i] = {table.place, table.over, table.channel, Curve<S>(table.at, table.value, table.count)};
      mark(table.place);
    }
    for (std::size_t i = 0; i < laws.surface_count; ++i) {
      surfaces_[i] = {laws.surfaces[i].place, Surface<S>(laws.surfaces[i])};
      mark(laws.surfaces[i].place);
    }
    for (std::size_t i = 0; i < laws.branch_count; ++i) {
      branches_[i] = {laws.branches[i].place, Branch<S>(laws.branches[i], period)};
      mark(laws.branches[i].place);
    }
    curve_count_ = laws.curve_count;
    surface_count_ = laws.surface_count;
    branch_count_ = laws.branch_count;
  }

  [[nodiscard]] bool at(LawPlace place) const { return acts_[index(place)]; }
  [[nodiscard]] bool any() const { return any_; }  ///< force

  /// What the sensor of a channel shows for its true value.
  [[nodiscard]] S reading(Channel channel, S truth) const {
    for (std::size_t i = 0; i < curve_count_; ++i) {
      const PlacedCurve& c = curves_[i];
      if (c.place == LawPlace::sensor && c.channel == channel) truth = c.law(truth);
    }
    return truth;
  }

  struct Change {
    S delta{}, weight{};  ///< Δ [N], w
  };

  /// (2), (3) for a step from x.at[place] to `free`; `growing`, `held`: r and q.
  [[nodiscard]] Change change(LawPlace place, const State& x, const Stroke<S>& free, const Stroke<S>& growing,
                              const Stroke<S>& held) const {
    const Stroke<S>& start = x.at[index(place)];
    const S moved = free.position - start.position, faster = free.velocity - start.velocity;
    S delta = S(0), stiffness = S(0), damping = S(0);  // Σ c over deflection and velocity
    for (std::size_t i = 0; i < curve_count_; ++i) {
      const PlacedCurve& c = curves_[i];
      if (c.place != place) continue;
      const bool velocity = c.over == LawOver::velocity;
      const S change = c.law(velocity ? free.velocity : free.position) - x.curves[i];
      delta += change;
      (velocity ? damping : stiffness) += chord(change, velocity ? faster : moved, c.law.steepest());
    }
    for (std::size_t i = 0; i < surface_count_; ++i) {
      const PlacedSurface& s = surfaces_[i];
      if (s.place != place) continue;
      const S corner = s.law(start.position, free.velocity);
      const S end = s.law(free.position, free.velocity);
      delta += end - x.surfaces[i];
      damping += chord(corner - x.surfaces[i], faster, s.law.steepest());
      stiffness += chord(end - corner, moved, s.law.stiffest());
    }
    for (std::size_t i = 0; i < branch_count_; ++i) {
      const PlacedBranch& b = branches_[i];
      if (b.place != place) continue;
      const S end = b.law.after(x.branches[i], moved);
      delta += end - x.branches[i];
      stiffness += chord(end - b.law.kept(x.branches[i]), moved, b.law.stiffness());
    }
    const auto resistance = [&](const Stroke<S>& response) {
      const S resists = -(stiffness * response.position + damping * response.velocity);
      return select(resists > S(0), resists, S(0));
    };
    const S grows = resistance(growing);
    const S weight = grows * grows / (S(1) + grows * grows);
    return {delta / (S(1) + grows + weight * (resistance(held) - grows)), weight};
  }

  /// The end of a step: the motion that it reached.
  void finish(LawPlace place, State& x, const Stroke<S>& end) const {
    const S moved = end.position - x.at[index(place)].position;
    S force = S(0);
    for (std::size_t i = 0; i < curve_count_; ++i) {
      const PlacedCurve& c = curves_[i];
      if (c.place == place) {
        force += x.curves[i] = c.law(c.over == LawOver::velocity ? end.velocity : end.position);
      }
    }
    for (std::size_t i = 0; i < surface_count_; ++i) {
      const PlacedSurface& s = surfaces_[i];
      if (s.place == place) force += x.surfaces[i] = s.law(end.position, end.velocity);
    }
    for (std::size_t i = 0; i < branch_count_; ++i) {
      const PlacedBranch& b = branches_[i];
      if (b.place == place) force += x.branches[i] = b.law.after(x.branches[i], moved);
    }
    x.force[index(place)] = force;
    x.at[index(place)] = end;
  }

  /// A place in this motion, branches without force.
  void start(LawPlace place, State& x, const Stroke<S>& motion) const {
    for (std::size_t i = 0; i < branch_count_; ++i) {
      if (branches_[i].place == place) x.branches[i] = S(0);
    }
    x.at[index(place)] = motion;
    finish(place, x, motion);
  }

  /// Forces and branches that have decayed below `least` become zero.
  void flush(State& x, S least) const {
    for (std::size_t i = 0; i < branch_count_; ++i) {
      S& u = x.branches[i];
      u = select(u < least && u > -least, S(0), u);
    }
  }

 private:
  struct PlacedCurve {
    LawPlace place{};
    LawOver over{};
    Channel channel{};
    Curve<S> law{};
  };
  struct PlacedSurface {
    LawPlace place{};
    Surface<S> law{};
  };
  struct PlacedBranch {
    LawPlace place{};
    Branch<S> law{};
  };

  constexpr void mark(LawPlace place) {
    acts_[index(place)] = true;
    any_ = any_ || place != LawPlace::sensor;
  }

  /// change/distance within 0 … steepest: neither a rounding error of a short distance nor a falling law gets beyond.
  [[nodiscard]] RIGTWIN_INLINE static S chord(S change, S distance, S steepest) {
    const S slope = select(distance == S(0), S(0), S(change / distance));
    return select(slope > S(0), select(slope < steepest, slope, steepest), S(0));
  }

  std::array<PlacedCurve, capacity.curves> curves_{};
  std::array<PlacedSurface, capacity.surfaces> surfaces_{};
  std::array<PlacedBranch, capacity.branches> branches_{};
  std::size_t curve_count_ = 0, surface_count_ = 0, branch_count_ = 0;
  std::array<bool, force_places + 1> acts_{};
  bool any_ = false;
};

/// Where there is no room for laws.
template <class S>
class PlacedLaws<S, no_laws> {
 public:
  static constexpr bool possible = false;
  struct State {};
  PlacedLaws() = default;
  PlacedLaws(const Laws<S, no_laws>& /*laws*/, S /*period*/) {}
  [[nodiscard]] static constexpr bool at(LawPlace /*place*/) { return false; }
  [[nodiscard]] static constexpr bool any() { return false; }
};

}  // namespace model
