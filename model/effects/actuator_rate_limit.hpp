// Velocity limit of the test machine.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Rate limit of the machine, last in its path: x_act follows what it is told as far as the limit lets it.
///
///   |ẋ_act| ≤ v,   x_act(k+1) = x_act(k) + clamp(x_in(k+1) − x_act(k), ± v h)
///
/// A clamp from sample to sample, not a fast follower: exact while it limits and while it does not.
/// Source: full opening of a servo valve at constant supply pressure.
template <class S>
struct ActuatorRateLimit {
  S velocity{};  ///< highest |ẋ_act| [m/s]

  static constexpr EffectCard<1> card{
      .name = "actuator_rate_limit",
      .subsystem = Subsystem::machine,
      .rigs = moved_rigs,
      .parameters = {{{.name = "velocity",
                       .unit = "m/s",
                       .lower = 1e-4,
                       .upper = 100.0,
                       .starts = {.scale = scales::velocity_peak, .factors = {0.9, 0.7, 0.5, 0.3}}}}},
      .equation = "ẋ_act limited to ± velocity while following x_cmd",
      .shows =
          "x_act goes straight at the steepest places of x_cmd and catches up afterwards; "
          "only large and fast motion is affected",
      .linearisation = Linearisation::left_out,
      .corner = Corner::rate_limit};
  static constexpr auto values = std::array{&ActuatorRateLimit::velocity};

  constexpr void act_on(MachinePath<S>& machine) const { machine.rate_limit = velocity; }
};

}  // namespace model
