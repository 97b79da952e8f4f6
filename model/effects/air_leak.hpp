// Leak of an air spring.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Gas that leaves the (first) bellows: a choked flow, in proportion to the absolute pressure inside.
///
///   ṁ = −rate · m₀ p/p₀
///
/// Choked above p = 1.9 p_a (air), which is where air springs work. Source: flow of an ideal gas through an orifice.
template <class S>
struct AirLeak {
  S rate{};  ///< share of the gas at rest that is lost in a second [1/s]

  static constexpr EffectCard<1> card{.name = "air_leak",
                                      .subsystem = Subsystem::air_spring,
                                      .rigs = every_rig,
                                      .needs_air_spring = true,
                                      .parameters = {{{.name = "rate",
                                                       .unit = "1/s",
                                                       .lower = 0.0,
                                                       .upper = 1.0,
                                                       .starts = {.scale = scales::unit, .factors = {1e-4, 2e-3}}}}},
                                      .equation = "ṁ = −rate · m₀ p/p₀",
                                      .shows = "the force falls, and the body sinks, steadily over the recording",
                                      .linearisation = Linearisation::left_out};
  static constexpr auto values = std::array{&AirLeak::rate};

  constexpr void act_on(AirSpringCondition<S>& air_spring) const { air_spring.leak = rate; }
};

}  // namespace model
