// A sensor that clips.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Clipping of one channel, on signal plus noise.
///
///   y = clamp(u, ± l)
template <class S>
struct SensorSaturation {
  S limit{};  ///< l [unit of the channel]

  static constexpr EffectCard<1> card{"sensor_saturation",
                                      Place::sensor,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"limit", "of the channel", 0.0, 1e9}}},
                                      "measured = true, limited to ± limit",
                                      "the same extreme value again and again, flat tops in this channel alone"};
  static constexpr auto values = std::array{&SensorSaturation::limit};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.limit = limit; }
};

}  // namespace model
