// The test machine follows like a second-order system.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

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

  static constexpr EffectCard<2> card{"actuator_resonance",
                                      Place::machine,
                                      RigKinds(RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"frequency", "Hz", 0.1, 10e3}, {"damping_ratio", "1", 0.0, 20.0}}},
                                      "ẍ_act + 2ζω ẋ_act + ω² x_act = ω² x_cmd",
                                      "amplitude of x_act rises towards the resonance and falls beyond, phase turns by "
                                      "180°; far below it looks like a delay 2ζ/ω"};
  static constexpr auto values = std::array{&ActuatorResonance::frequency, &ActuatorResonance::damping_ratio};

  constexpr void act_on(MachinePath<S>& machine) const {
    machine.resonance_frequency = frequency;
    machine.resonance_damping = damping_ratio;
  }
};

}  // namespace model
