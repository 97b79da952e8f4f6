// Mass that moves between load cell and component.
#pragma once

#include <algorithm>

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Inertia force of the clamp, rod and adapter that a test machine moves in front of its load cell.
///
///   F_measured = F + m ẍ_act
///
/// In a hil rig the measured force goes back into the virtual car: the loop is neutral then (its highest derivative is
/// delayed), which the linear analysis of the loop does not cover.
template <class S>
struct MovingMass {
  S mass{};  ///< m [kg]

  static constexpr EffectCard<1> card{
      .name = "moving_mass",
      .subsystem = Subsystem::sensor,
      .rigs = RigKinds(RigKind::hil, RigKind::component_bench),
      .parameters = {{{.name = "mass",
                       .unit = "kg",
                       .lower = 0.0,
                       .upper = 1000.0,
                       .starts = {.scale =
                                      [](const MotionScales& s) {
                                        return s.force / std::max(s.acceleration, scales::least);
                                      },
                                  .factors = {0.01, 0.1, 1.0}}}}},
      .equation = "F_measured = F + mass · ẍ_act",
      .shows =
          "the measured force departs in proportion to the machine's acceleration, so with the square of frequency, "
          "in phase opposition to a spring",
      .linearisation = Linearisation::left_out};
  static constexpr auto values = std::array{&MovingMass::mass};

  constexpr void act_on(LoadCell<S>& cell) const { cell.moving_mass += mass; }
};

}  // namespace model
