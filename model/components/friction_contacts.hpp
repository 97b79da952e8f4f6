// Dry friction between parts that are free to move.
#pragma once

#include <array>

#include "model/numerics/exact_discretisation.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// Coulomb friction at up to four contacts, sharp and unconditionally stable.
///
///   (1)  λ_p = f_p sgn(v_p)  while slipping,   |λ_p| ≤ f_p  while v_p = 0
///   (2)  v(s) = v₀ + s (v_free − v₀) − s |G| λ     s = 0 … 1 through the step, G: change of v by a unit of λ in a step
///
/// Within a step the velocity of a contact changes in proportion to time (2). A slipping contact goes on slipping.
/// Where it comes to rest before the end of the step, it sticks if at most f holds it, else it slips the other way. The
/// step gets the mean of these forces, the end of the step the last of them. Several contacts are solved by projected
/// Gauss–Seidel sweeps that start from the forces of the last step: a fixed number, fewer only where another sweep
/// would change nothing. Second order in the step, also where a contact sticks, slips or reverses. Work that friction
/// does in a step, −λ Δe, is never positive but for the part of a step in which a contact reverses, f (f h/m) h/8 at
/// most. Source: Moreau, time stepping of unilateral and frictional contact, 1988; Acary and Brogliato, Numerical
/// methods for nonsmooth dynamical systems, 2008; the event within the step after (2) is our own.
template <class S>
class FrictionContacts {
 public:
  enum Contact : int { suspension, piston, wheel_guide, body_guide };
  static constexpr int contacts = 4;
  static constexpr int sweeps =
      12;  ///< remaining error of λ: below 1e-3 f for guides and suspension of any rig (tests)

  using Forces = std::array<S, contacts>;

  FrictionContacts() = default;
  explicit FrictionContacts(const Forces& limits) : limits_(limits) {
    for (int p = 0; p < contacts; ++p) {
      if (same(at(limits_, p) > S(0))) list_[static_cast<std::size_t>(count_++)] = p;
    }
  }

  [[nodiscard]] bool any() const { return count_ > 0; }
  [[nodiscard]] const Forces& limits() const { return limits_; }

  /// Adds the friction of one step to x, the state that the step reaches from `start` without friction. Velocities: v_p
  /// = velocity(p, x). `columns.col(p)`: change of x by a unit of λ_p in one step; `limits`: f_p of this step;
  /// `forces`: λ at the end of the last step, replaced by that at the end of this.
  template <int N, class Velocity>
  void solve(Column<S, N>& x, const Column<S, N>& start, const Block<S, N, contacts>& columns, const Forces& limits,
             Forces& forces, const Velocity& velocity) const {
    Forces mean = forces;
    for (int i = 0; i < count_; ++i) x += columns.col(list(i)) * at(mean, list(i));
    const int rounds = count_ == 1 ? 1 : sweeps;
    bool moved = true;
    for (int round = 0; round < rounds && moved; ++round) {
      moved = false;
      for (int i = 0; i < count_; ++i) {
        const int p = list(i);
        const Column<S, N> column = columns.col(p);
        const S slowing = -velocity(p, column);
        const auto yields = slowing > S(0);
        if (!any_lane(yields)) continue;  // a locked piston cannot be slowed
        const S free = velocity(p, x) + slowing * at(mean, p);
        Friction friction = friction_of(velocity(p, start), free, slowing, at(limits, p));
        if (!all_lanes(yields)) {
          friction = {select(yields, friction.mean, at(mean, p)), select(yields, friction.last, at(forces, p))};
        }
        moved = moved || any_lane(friction.mean != at(mean, p));
        x += column * (friction.mean - at(mean, p));
        at(mean, p) = friction.mean;
        at(forces, p) = friction.last;
      }
    }
  }

 private:
  struct Friction {
    S mean, last;  ///< over the step, at its end [N]
  };

  /// One contact whose velocity goes from `before` to `free` without friction; `slowing`: |G|.
  [[nodiscard]] static Friction friction_of(S before, S free, S slowing, S limit) {
    const S slipping = select(before > S(0), limit, select(before < S(0), S(-limit), S(0)));
    const S arriving = free - slowing * slipping;
    const auto slips_on = before * arriving > S(0);
    if (all_lanes(slips_on)) return {slipping, slipping};
    // share of the step until it is at rest
    const S stop = select(before == arriving, S(0), S(before / (before - arriving)));
    const S holding = (free - before) / slowing;
    const S after = select(holding > limit, limit, select(holding < -limit, S(-limit), holding));
    return {select(slips_on, slipping, S(stop * slipping + (S(1) - stop) * after)), select(slips_on, slipping, after)};
  }

  template <class Array>
  static constexpr auto& at(Array& array, int p) {
    return array[static_cast<std::size_t>(p)];
  }
  [[nodiscard]] int list(int i) const { return list_[static_cast<std::size_t>(i)]; }

  Forces limits_{};
  std::array<int, contacts> list_{};
  int count_ = 0;
};

}  // namespace model
