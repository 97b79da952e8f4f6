// Does the delayed interface of a hil rig drive the car that it should only carry?
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/loop/settings.hpp"
#include "firmware/loop/trip.hpp"

namespace firmware {

/// Follows the energy that the interface – machine, component, force sensor, held for a period – feeds into the virtual
/// car, against what the car's own dampers take out of it:
///
///   (1)  W ← λ W − F (x⁺ − x)                                      fed: work of the held force F on the car, exact
///   (2)  D ← λ D + (b̃ (x⁺ − x)² + b_t (z_w⁺ − z_w)²)/h             taken: virtual damping, and the tyre's on a flat
///   road (3)  λ = 1 − h/memory
///
/// x = z_w − z_b is the deflection, h the period, ⁺ its end. A passive component takes energy (W < 0); behind a delay
/// it may feed. When W outweighs D, what remains can only go into motion: on the border of stability W = D. Judged once
/// a cycle, where the deflection turns from falling to rising; a hazard after energy_cycles cycles in a row with W >
/// energy_gain · D, of cycles that are wider than energy_quiet. Some ten additions and products a period.
///
/// Leaves out: what the road does through the tyre's damper. Guides there are none: in a hil rig body and wheel are
/// numbers, and a rig description that gives them drag or friction is refused.
class EnergyGuard {
 public:
  /// b̃ [N s/m], b_t [N s/m] ≥ 0.
  EnergyGuard(const Limits& limits, double virtual_damping, double tyre_damping, double period);

  /// The car begins at rest, with this deflection [m].
  void start(double deflection);

  /// One period: force held [N], deflection at its end [m], way of the wheel [m]. A hazard, time not filled in.
  [[nodiscard]] std::optional<Trip> follow(double force, double deflection, double wheel_way);

  [[nodiscard]] double fed() const { return fed_; }      ///< W [J]
  [[nodiscard]] double taken() const { return taken_; }  ///< D [J]

 private:
  double gain_;
  double quiet_;
  int most_cycles_;
  double memory_;           ///< λ
  double virtual_damping_;  ///< b̃/h [N/m]
  double tyre_damping_;     ///< b_t/h [N/m]

  double fed_ = 0.0;
  double taken_ = 0.0;
  double deflection_ = 0.0;
  double lowest_ = 0.0;   ///< deflection in this cycle
  double highest_ = 0.0;  ///< deflection in this cycle
  bool falling_ = false;
  int cycles_ = 0;  ///< in a row
};

}  // namespace firmware
