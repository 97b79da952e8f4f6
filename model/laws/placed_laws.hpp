// The laws of a rig in steps.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "model/laws/behind_spring.hpp"
#include "model/laws/branch.hpp"
#include "model/laws/curve.hpp"
#include "model/laws/surface.hpp"
#include "model/numerics/inline.hpp"
#include "model/numerics/motion.hpp"

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
    std::array<S, capacity.curves> curves{};   ///< by place, as in PlacedLaws
    std::array<typename Curve<S>::Place, capacity.curves> places{};
    std::array<S, capacity.surfaces> surfaces{};
    std::array<S, capacity.branches> branches{};  ///< w of Branch
  };

  PlacedLaws() = default;
  PlacedLaws(const Laws<S, capacity>& laws, S period) {
    for (std::size_t p = 0; p <= force_places; ++p) {
      const auto place = static_cast<LawPlace>(p);
      for (std::size_t i = 0; i < laws.curve_count; ++i) {
        const CurveTable<S>& table = laws.curves[i];
        if (table.place != place) continue;
        PlacedCurve& curve = curves_[end_[p].curves++];
        curve = {table.over, table.channel, Curve<S>(table.at, table.value, table.count)};
        curve.is_behind = place != LawPlace::sensor && same(table.behind > S(0));
        if (curve.is_behind) curve.spring = BehindSpring<S>(table.behind, table.over, period);
      }
      for (std::size_t i = 0; i < laws.surface_count; ++i) {
        if (laws.surfaces[i].place == place) surfaces_[end_[p].surfaces++] = Surface<S>(laws.surfaces[i]);
      }
      for (std::size_t i = 0; i < laws.branch_count; ++i) {
        if (laws.branches[i].place == place) branches_[end_[p].branches++] = Branch<S>(laws.branches[i], period);
      }
      if (p < force_places) end_[p + 1] = end_[p];
    }
  }

  [[nodiscard]] bool at(LawPlace place) const { return !(begin(place) == end(place)); }
  [[nodiscard]] bool any() const { return !(end(LawPlace::wheel_guide) == Count{}); }  ///< force

  /// What the sensor of a channel shows for its true value.
  [[nodiscard]] S reading(Channel channel, S truth) const {
    for (std::size_t i = begin(LawPlace::sensor).curves; i < end(LawPlace::sensor).curves; ++i) {
      if (curves_[i].channel == channel) truth = curves_[i].law(truth);
    }
    return truth;
  }

  struct Change {
    S delta{}, weight{};  ///< Δ [N], w
  };

  /// (2), (3) for a step from x.at[place] to `free`; `growing`, `held`: r and q.
  [[nodiscard]] RIGTWIN_INLINE Change change(LawPlace place, State& x, const Stroke<S>& free, const Stroke<S>& growing,
                                             const Stroke<S>& held) const {
    const Count first = begin(place), last = end(place);
    const Stroke<S>& start = x.at[index(place)];
    const S moved = free.position - start.position, faster = free.velocity - start.velocity;
    // divided while the laws are evaluated, which takes as long
    const S per_moved = inverse(moved), per_faster = inverse(faster);
    S delta = S(0), stiffness = S(0), damping = S(0);  // Σ c over deflection and velocity
    for (std::size_t i = first.curves; i < last.curves; ++i) {
      const PlacedCurve& c = curves_[i];
      if (c.is_behind) {
        const S end = behind(c, x.curves[i], free.position, moved);
        delta += end - x.curves[i];
        stiffness += chord(end - behind(c, x.curves[i], start.position, S(0)), per_moved, c.spring.stiffness());
        continue;
      }
      const bool velocity = c.over == LawOver::velocity;
      const S change = c.law.near(velocity ? free.velocity : free.position, x.places[i]) - x.curves[i];
      delta += change;
      (velocity ? damping : stiffness) += chord(change, velocity ? per_faster : per_moved, c.law.steepest());
    }
    for (std::size_t i = first.surfaces; i < last.surfaces; ++i) {
      const Surface<S>& law = surfaces_[i];
      const S corner = law(start.position, free.velocity);
      const S end = law(free.position, free.velocity);
      delta += end - x.surfaces[i];
      damping += chord(corner - x.surfaces[i], per_faster, law.steepest());
      stiffness += chord(end - corner, per_moved, law.stiffest());
    }
    for (std::size_t i = first.branches; i < last.branches; ++i) {
      const Branch<S>& law = branches_[i];
      const S end = law.force(law.after(x.branches[i], moved));
      delta += end - law.force(x.branches[i]);
      stiffness += chord(end - law.force(law.kept(x.branches[i])), per_moved, law.stiffness());
    }
    const auto resistance = [&](const Stroke<S>& response) {
      const S resists = -(stiffness * response.position + damping * response.velocity);
      return select(resists > S(0), resists, S(0));
    };
    const S grows = resistance(growing), square = grows * grows, one = S(1) + square;
    return {delta * one / ((S(1) + grows) * one + square * (resistance(held) - grows)), square / one};
  }

  /// The end of a step: the motion that it reached.
  RIGTWIN_INLINE void finish(LawPlace place, State& x, const Stroke<S>& motion) const {
    const Count first = begin(place), last = end(place);
    const S moved = motion.position - x.at[index(place)].position;
    S force = S(0);
    for (std::size_t i = first.curves; i < last.curves; ++i) {
      const PlacedCurve& c = curves_[i];
      if (c.is_behind) {
        force += x.curves[i] = behind(c, x.curves[i], motion.position, moved);
        continue;
      }
      const bool velocity = c.over == LawOver::velocity;
      force += x.curves[i] = c.law.near(velocity ? motion.velocity : motion.position, x.places[i]);
    }
    for (std::size_t i = first.surfaces; i < last.surfaces; ++i) {
      force += x.surfaces[i] = surfaces_[i](motion.position, motion.velocity);
    }
    for (std::size_t i = first.branches; i < last.branches; ++i) {
      x.branches[i] = branches_[i].after(x.branches[i], moved);
      force += branches_[i].force(x.branches[i]);
    }
    x.force[index(place)] = force;
    x.at[index(place)] = motion;
  }

  /// A place in this motion; branches without force, curves over a velocity behind a spring with that of rest.
  void start(LawPlace place, State& x, const Stroke<S>& motion) const {
    for (std::size_t i = begin(place).branches; i < end(place).branches; ++i) x.branches[i] = S(0);
    for (std::size_t i = begin(place).curves; i < end(place).curves; ++i) x.curves[i] = curves_[i].law(S(0));
    x.at[index(place)] = motion;
    finish(place, x, motion);
  }

  /// Forces that have decayed below `least` are none.
  void flush(State& x, S least) const {
    for (std::size_t i = 0; i < end(LawPlace::sensor).curves; ++i) {
      S& u = x.curves[i];
      if (curves_[i].is_behind) u = select(u < least && u > -least, S(0), u);
    }
    for (std::size_t i = 0; i < end(LawPlace::sensor).branches; ++i) {
      S& u = x.branches[i];
      u = select(u < least && u > -least, S(0), u);
    }
  }

 private:
  struct PlacedCurve {
    LawOver over{};
    Channel channel{};
    Curve<S> law{};
    bool is_behind = false;
    BehindSpring<S> spring{};
  };
  struct Count {
    std::uint8_t curves = 0, surfaces = 0, branches = 0;
    friend constexpr bool operator==(const Count&, const Count&) = default;
  };
  [[nodiscard]] RIGTWIN_INLINE Count begin(LawPlace place) const {
    return place == LawPlace{} ? Count{} : end_[index(place) - 1];
  }
  [[nodiscard]] RIGTWIN_INLINE Count end(LawPlace place) const { return end_[index(place)]; }

  /// The force of a curve behind a spring at this deflection, after this travel from the force before.
  [[nodiscard]] static S behind(const PlacedCurve& c, S before, S deflection, S travel) {
    return c.over == LawOver::velocity ? c.spring.after(c.law, before, travel) : c.spring.at(c.law, deflection);
  }
  /// 1/distance, 0 for no distance.
  [[nodiscard]] RIGTWIN_INLINE static S inverse(S distance) {
    return select(distance == S(0), S(0), S(S(1) / distance));
  }
  /// change/distance within 0 … steepest: neither a rounding error of a short distance nor a falling law gets beyond.
  [[nodiscard]] RIGTWIN_INLINE static S chord(S change, S per_distance, S steepest) {
    const S slope = change * per_distance;
    return select(slope > S(0), select(slope < steepest, slope, steepest), S(0));
  }

  std::array<PlacedCurve, capacity.curves> curves_{};  ///< by place
  std::array<Surface<S>, capacity.surfaces> surfaces_{};
  std::array<Branch<S>, capacity.branches> branches_{};
  std::array<Count, force_places + 1> end_{};  ///< of the laws of a place; each begins where the one before ends
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
