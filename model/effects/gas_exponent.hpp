// Polytropic exponent of an air spring that is not the described one.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// The gas is compressed with another exponent: 1 isothermal, 1.4 air without heat exchange, 1.67 a monatomic gas.
///
///   p V^exponent = constant in place of p V^κ
template <class S>
struct GasExponent {
  S exponent{};  ///< κ [1]

  static constexpr EffectCard<1> card{
      .name = "gas_exponent",
      .subsystem = Subsystem::air_spring,
      .rigs = every_rig,
      .needs_air_spring = true,
      .parameters = {{{.name = "exponent",
                       .unit = "1",
                       .lower = 1.0,
                       .upper = 1.67,
                       .starts = {.scale = scales::unit, .factors = {1.05, 1.2, 1.3, 1.5}},
                       .neutral = 1.4}}},
      .equation = "p V^exponent = constant in place of p V^κ",
      .shows = "stiffness wrong by one factor above 0.5 Hz, and right when the load changes slowly",
      .linearisation = Linearisation::exact};
  static constexpr auto values = std::array{&GasExponent::exponent};

  constexpr void act_on(AirSpringCondition<S>& air_spring) const { air_spring.polytropic_exponent = exponent; }
};

}  // namespace model
