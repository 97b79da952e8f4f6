// The test machine follows like a first-order system.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

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
      "actuator_lag",
      Place::machine,
      RigKinds(RigKind::hil, RigKind::component_bench),
      false,
      {{{"time_constant", "s", 0.0, 1.0}}},
      "T ẋ_act + x_act = x_cmd",
      "amplitude of x_act falls and its phase lags towards 90° above 1/(2πT); a small one looks like a delay T"};
  static constexpr auto values = std::array{&ActuatorLag::time_constant};

  constexpr void act_on(MachinePath<S>& machine) const { machine.lag = time_constant; }
};

}  // namespace model
