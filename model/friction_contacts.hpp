// Dry friction between parts that are free to move.
#pragma once

#include <array>

#include "model/exact_discretisation.hpp"

namespace model {

/// Coulomb friction at up to four contacts, sharp and unconditionally stable.
///
///   (1)  λ_p = f_p sgn(v_p)  while slipping,   |λ_p| ≤ f_p  while v_p = 0
///
/// The friction forces λ are constant over a step and chosen such that (1) holds at its end, where the linear system
/// gives v = v_free + G λ. One contact is solved exactly: λ = clamp(−v_free/G, ±f). More are solved by a fixed number
/// of projected Gauss–Seidel sweeps, started from the forces of the last step. Energy can only be lost: λ v ≥ 0.
/// First order in the step at the instants where sticking begins or slip reverses, exact between them while slipping;
/// while sticking under a load that grows by Ḟ a mass m creeps back by Ḟ h³/(12 m) a step. Source: Moreau, time
/// stepping of unilateral and frictional contact, 1988; Acary and Brogliato, Numerical methods for nonsmooth dynamical
/// systems, 2008.
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
      if (at(limits_, p) > S(0)) list_[static_cast<std::size_t>(count_++)] = p;
    }
  }

  [[nodiscard]] bool any() const { return count_ > 0; }
  [[nodiscard]] const Forces& limits() const { return limits_; }

  /// Adds the friction of one step to x, whose velocities v_p = velocity(p, x) are the free ones; `columns.col(p)` is
  /// what a unit of λ_p does in one step; `limits`: f_p of this step; `forces`: λ of the last step, replaced by the new
  /// one.
  template <int N, class Velocity>
  void solve(Column<S, N>& x, const Block<S, N, contacts>& columns, const Forces& limits, Forces& forces,
             const Velocity& velocity) const {
    for (int i = 0; i < count_; ++i) x += columns.col(list(i)) * at(forces, list(i));
    const int rounds = count_ == 1 ? 1 : sweeps;
    for (int round = 0; round < rounds; ++round) {
      for (int i = 0; i < count_; ++i) {
        const int p = list(i);
        const Column<S, N> column = columns.col(p);
        const S gain = velocity(p, column);
        if (!(gain < S(0))) continue;  // a locked piston cannot be slowed
        const S limit = at(limits, p);
        const S wanted = at(forces, p) - velocity(p, x) / gain;
        const S now = wanted > limit ? limit : (wanted < -limit ? -limit : wanted);
        x += column * (now - at(forces, p));
        at(forces, p) = now;
      }
    }
  }

 private:
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
