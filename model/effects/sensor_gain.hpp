// A sensor whose scale is wrong.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Scale error of one channel; its noise keeps its size.
///
///   y = g u
template <class S>
struct SensorGain {
  S gain{};  ///< g [1]

  static constexpr EffectCard<1> card{
      "sensor_gain",
      Place::sensor,
      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
      false,
      {{{"gain", "1", -100.0, 100.0}}},
      "measured = gain · true",
      "this channel alone is larger or smaller by one factor at every frequency and amplitude"};
  static constexpr auto values = std::array{&SensorGain::gain};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.gain = gain; }
};

}  // namespace model
