// Pure delay of the test machine.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

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
      .name = "actuator_delay",
      .subsystem = Subsystem::machine,
      .rigs = moved_rigs,
      .parameters = {{{.name = "delay",
                       .unit = "s",
                       .lower = 0.0,
                       .upper = 0.5,
                       .starts = {.scale = scales::millisecond, .factors = {0.3, 1.0, 3.0, 10.0, 30.0}}}}},
      .equation = "x_act(t) = x_cmd(t − delay)",
      .shows =
          "phase lag of x_act behind x_cmd that grows in proportion to frequency, at unchanged amplitude; in a hil rig "
          "the "
          "wheel mode loses damping",
      .linearisation = Linearisation::exact,
      .lateness = Lateness::delay};
  static constexpr auto values = std::array{&ActuatorDelay::delay};

  constexpr void act_on(MachinePath<S>& machine) const { machine.delay = delay; }
};

}  // namespace model
