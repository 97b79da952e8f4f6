// A sensor whose zero is wrong.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Zero error of one channel.
///
///   y = u + o
template <class S>
struct SensorOffset {
  S offset{};  ///< o [unit of the channel], either sign

  static constexpr EffectCard<1> card{"sensor_offset",
                                      Place::sensor,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"offset", "of the channel", -1e6, 1e6}}},
                                      "measured = true + offset",
                                      "the mean of this channel alone is wrong, its motion is right"};
  static constexpr auto values = std::array{&SensorOffset::offset};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.offset = offset; }
};

}  // namespace model
