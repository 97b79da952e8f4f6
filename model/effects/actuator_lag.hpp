// First-order lag of the test machine.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// First-order lag of the machine path, exact for the cubic between two samples.
///
///   T ẋ_act + x_act = x_cmd
///
/// Source: closed position loop of a servo drive with one dominant pole.
template <class S>
struct ActuatorLag {
  S time_constant{};  ///< T [s]

  static constexpr EffectCard<1> card{
      .name = "actuator_lag",
      .subsystem = Subsystem::machine,
      .rigs = moved_rigs,
      .parameters = {{{.name = "time_constant",
                       .unit = "s",
                       .lower = 0.0,
                       .upper = 1.0,
                       .starts = {.scale = scales::millisecond, .factors = {0.3, 1.0, 3.0, 10.0, 30.0}}}}},
      .equation = "T ẋ_act + x_act = x_cmd",
      .shows =
          "amplitude of x_act falls and its phase lags towards 90° above 1/(2πT); a small one looks like a delay T",
      .linearisation = Linearisation::exact,
      .lateness = Lateness::lag};
  static constexpr auto values = std::array{&ActuatorLag::time_constant};

  constexpr void act_on(MachinePath<S>& machine) const { machine.lag = time_constant; }
};

}  // namespace model
