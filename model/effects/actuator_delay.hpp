// The test machine reaches the commanded deflection late.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Pure delay of the machine path.
///
///   x_act(t) = x_cmd(t − τ)
///
/// Seen through it a component K(jω) becomes K e^{−jωτ}: a spring k loses the damping k τ.
/// Source: any transport or computation time between command and motion; TU Darmstadt measured τ = 10 ms.
template <class S>
struct ActuatorDelay {
  S delay{};  ///< τ [s]

  static constexpr EffectCard<1> card{
      "actuator_delay",
      Place::machine,
      RigKinds(RigKind::hil, RigKind::component_bench),
      false,
      {{{"delay", "s", 0.0, 0.5}}},
      "x_act(t) = x_cmd(t − delay)",
      "phase lag of x_act behind x_cmd that grows in proportion to frequency, at unchanged amplitude; in a hil rig the "
      "wheel mode loses damping"};
  static constexpr auto values = std::array{&ActuatorDelay::delay};

  constexpr void act_on(MachinePath<S>& machine) const { machine.delay = delay; }
};

}  // namespace model
