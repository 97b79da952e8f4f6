// Saturation of a sensor.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Clipping of one channel, on signal plus noise.
///
///   y = clamp(u, ± l)
template <class S>
struct SensorSaturation {
  S limit{};  ///< l [unit of the channel]

  static constexpr EffectCard<1> card{
      .name = "sensor_saturation",
      .subsystem = Subsystem::sensor,
      .rigs = every_rig,
      .parameters = {{{.name = "limit",
                       .unit = "of the channel",
                       .lower = 0.0,
                       .upper = 1e9,
                       .starts = {.read = Reading::repeated_extreme}}}},
      .equation = "measured = true, limited to ± limit",
      .shows = "the same extreme value again and again, flat tops in this channel alone",
      .linearisation = Linearisation::left_out};
  static constexpr auto values = std::array{&SensorSaturation::limit};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.limit = limit; }
};

}  // namespace model
