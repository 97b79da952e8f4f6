// A sensor with a first-order low-pass.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// First-order low-pass of one channel, on signal plus noise, exact for a signal that moves on a cubic between
/// samples.
///
///   T ẏ + y = u
template <class S>
struct SensorLag {
  S time_constant{};  ///< T [s]

  static constexpr EffectCard<1> card{"sensor_lag",
                                      Place::sensor,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"time_constant", "s", 0.0, 1.0}}},
                                      "first-order low-pass in that channel",
                                      "this channel alone falls and lags above 1/(2πT); its noise is low-passed too"};
  static constexpr auto values = std::array{&SensorLag::time_constant};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.lag = time_constant; }
};

}  // namespace model
