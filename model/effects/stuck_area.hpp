// Stuck actuator of an air spring.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// The area stays where it is, whatever is commanded.
///
///   u = position
template <class S>
struct StuckArea {
  S position{};  ///< relative change of the area [1]

  static constexpr EffectCard<1> card{.name = "stuck_area",
                                      .subsystem = Subsystem::air_spring,
                                      .rigs = every_rig,
                                      .needs_air_spring = true,
                                      .parameters = {{{.name = "position",
                                                       .unit = "1",
                                                       .lower = -1.0,
                                                       .upper = 1.0,
                                                       .starts = {.scale = scales::unit, .factors = {0.0}}}}},
                                      .equation = "u = position",
                                      .shows =
                                          "no force follows the skyhook command; a constant force if it is stuck "
                                          "away from the middle",
                                      .linearisation = Linearisation::exact};
  static constexpr auto values = std::array{&StuckArea::position};

  constexpr void act_on(AirSpringCondition<S>& air_spring) const {
    air_spring.stuck = true;
    air_spring.stuck_at = position;
  }
};

}  // namespace model
