// A sensor that is late.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Pure delay of one channel, on signal plus noise.
///
///   y(t) = u(t − τ)
template <class S>
struct SensorDelay {
  S delay{};  ///< τ [s]

  static constexpr EffectCard<1> card{"sensor_delay",
                                      Place::sensor,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"delay", "s", 0.0, 0.5}}},
                                      "that channel alone is late",
                                      "this channel alone lags in proportion to frequency, at unchanged amplitude"};
  static constexpr auto values = std::array{&SensorDelay::delay};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.delay = delay; }
};

}  // namespace model
