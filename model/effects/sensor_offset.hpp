// Zero error of a sensor.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Zero error of one channel.
///
///   y = u + o
template <class S>
struct SensorOffset {
  S offset{};  ///< o [unit of the channel], either sign

  static constexpr EffectCard<1> card{
      .name = "sensor_offset",
      .subsystem = Subsystem::sensor,
      .rigs = every_rig,
      .parameters = {{{.name = "offset",
                       .unit = "of the channel",
                       .lower = -1e6,
                       .upper = 1e6,
                       .starts = {.scale = scales::channel, .factors = {0.05, -0.05}}}}},
      .equation = "measured = true + offset",
      .shows = "the mean of this channel alone is wrong, its motion is right",
      .linearisation = Linearisation::left_out};
  static constexpr auto values = std::array{&SensorOffset::offset};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.offset = offset; }
};

}  // namespace model
