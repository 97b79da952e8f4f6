// The test machine has a highest speed.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

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

  static constexpr EffectCard<1> card{"actuator_rate_limit",
                                      Place::machine,
                                      RigKinds(RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"velocity", "m/s", 1e-4, 100.0}}},
                                      "ẋ_act limited to ± velocity while following x_cmd",
                                      "x_act goes straight at the steepest places of x_cmd and catches up afterwards; "
                                      "only large and fast motion is affected"};
  static constexpr auto values = std::array{&ActuatorRateLimit::velocity};

  constexpr void act_on(MachinePath<S>& machine) const { machine.rate_limit = velocity; }
};

}  // namespace model
