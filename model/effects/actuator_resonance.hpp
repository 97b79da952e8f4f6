// Second-order response of the test machine.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Second-order machine path, exact for the cubic between two samples.
///
///   ẍ_act + 2ζω ẋ_act + ω² x_act = ω² x_cmd,   ω = 2πf
///
/// Source: oil column of a servo-hydraulic cylinder against the moving mass, in closed loop.
template <class S>
struct ActuatorResonance {
  S frequency{};      ///< f = ω/2π [Hz]
  S damping_ratio{};  ///< ζ [1]

  static constexpr EffectCard<2> card{
      .name = "actuator_resonance",
      .subsystem = Subsystem::machine,
      .rigs = moved_rigs,
      .parameters = {{{.name = "frequency",
                       .unit = "Hz",
                       .lower = 0.1,
                       .upper = 10e3,
                       .starts = {.scale = scales::unit, .factors = {6.0, 12.0, 25.0, 50.0}}},
                      {.name = "damping_ratio",
                       .unit = "1",
                       .lower = 0.0,
                       .upper = 20.0,
                       .starts = {.scale = scales::unit, .factors = {0.1, 0.4, 0.8}}}}},
      .equation = "ẍ_act + 2ζω ẋ_act + ω² x_act = ω² x_cmd",
      .shows =
          "amplitude of x_act rises towards the resonance and falls beyond, phase turns by "
          "180°; far below it looks like a delay 2ζ/ω",
      .linearisation = Linearisation::exact,
      .lateness = Lateness::resonance};
  static constexpr auto values = std::array{&ActuatorResonance::frequency, &ActuatorResonance::damping_ratio};

  constexpr void act_on(MachinePath<S>& machine) const {
    machine.resonance_frequency = frequency;
    machine.resonance_damping = damping_ratio;
  }
};

}  // namespace model
