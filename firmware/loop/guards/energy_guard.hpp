// Does the delayed interface of a hil rig drive the car that it should only carry?
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"

namespace firmware {

/// Follows the energy that the interface – machine, component, force sensor, held for a period – feeds into the virtual
/// car, against what the car's own dampers take out of it:
///
///   (1)  f = F − F̄,  F̄ ← F̄ + (1 − λ)(F − F̄)                force without its mean: an offset does not count
///   (2)  y = x − x̄,  x̄ ← x̄ + (1 − λ)(x − x̄)                deflection without its mean, by the same filter
///   (3)  W ← λ W − f (y⁺ − y)                               fed: work of the held force on the car
///   (4)  D ← λ D + (b̃ (y⁺ − y)² + b_t (z_w⁺ − z_w)²)/h      taken: virtual damping, and the tyre's on a flat road
///   (5)  W°, D°: the same sums over the periods in which |y| grows
///   (6)  λ = 1 − h/memory
///
/// x = z_w − z_b is the deflection, h the period, ⁺ its end. A passive component takes energy (W < 0); behind a delay
/// it may feed. When W outweighs D, what remains can only go into motion: on the border of stability W = D. Both
/// filters are alike, so a linear component is the same between f and y as between F and x, whatever its offset.
///
/// Oscillation: judged once a cycle, where the deflection turns from falling to rising; a hazard (energy) after
/// energy_cycles cycles in a row with W > energy_gain · D, of cycles that are wider than energy_quiet.
/// Divergence without oscillation: a hazard (growth) when W° > energy_gain · D° for growth_time, while |y| is above
/// energy_quiet and y keeps its sign. A component that pushes outwards has a negative stiffness: a wrong sign of F or
/// of the command, no equilibrium. For x = x₀ e^(st) with m s² + b̃ s = −k the sums have the ratio −k/(b̃ s) > 1.
/// Some twenty additions and products a period.
///
/// While the force is faded in at the begin of a run it is given whole, and nothing is judged. From rest (1) and (2) are one
/// filter of one relation; begun in mid-motion they are not: f and y would count from values of that instant, and what a
/// component with inertia gives back outwards, having taken it before, would be fed by nobody.
///
/// Leaves out: what the road does through the tyre's damper. Guides there are none: in a hil rig body and wheel are
/// numbers, and a rig description that gives them drag or friction is refused.
class EnergyGuard {
 public:
  /// b̃ [N s/m], b_t [N s/m] ≥ 0.
  EnergyGuard(const Limits& limits, double virtual_damping, double tyre_damping, double period,
              double growth_time = Supervision{}.growth_time);

  /// The car begins at rest, with this deflection [m].
  void start(double deflection);

  /// What has been judged so far counts for nothing: cycles in a row, time of growth. (1) to (5) go on.
  void begin_judging() {
    cycles_ = 0;
    growing_ = 0.0;
  }

  /// One period: force held [N], deflection at its end [m], way of the wheel [m].
  [[nodiscard]] std::optional<Trip> follow(double force, double deflection, double wheel_way,
                                           hal::Time now = hal::never);

  [[nodiscard]] double fed() const { return fed_; }                        ///< W [J]
  [[nodiscard]] double taken() const { return taken_; }                    ///< D [J]
  [[nodiscard]] double fed_outwards() const { return fed_outwards_; }      ///< W° [J]
  [[nodiscard]] double taken_outwards() const { return taken_outwards_; }  ///< D° [J]

 private:
  [[nodiscard]] std::optional<Trip> judge_growth(hal::Time now);

  double gain_;
  double quiet_;
  double growth_time_;
  double period_;
  int most_cycles_;
  double memory_;           ///< λ
  double virtual_damping_;  ///< b̃/h [N/m]
  double tyre_damping_;     ///< b_t/h [N/m]

  double fed_ = 0.0;
  double taken_ = 0.0;
  double fed_outwards_ = 0.0;     ///< W° [J]
  double taken_outwards_ = 0.0;   ///< D° [J]
  double growing_ = 0.0;          ///< for so long [s]
  double mean_force_ = 0.0;       ///< F̄ [N]
  double mean_deflection_ = 0.0;  ///< x̄ [m]
  double offset_free_ = 0.0;      ///< y [m]
  bool begun_ = false;            ///< a force has been seen
  double deflection_ = 0.0;
  double lowest_ = 0.0;   ///< deflection in this cycle
  double highest_ = 0.0;  ///< deflection in this cycle
  bool falling_ = false;
  int cycles_ = 0;  ///< in a row
};

}  // namespace firmware
