// Pure delay of a sensor.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Pure delay of one channel, on signal plus noise.
///
///   y(t) = u(t − τ)
template <class S>
struct SensorDelay {
  S delay{};  ///< τ [s]

  static constexpr EffectCard<1> card{
      .name = "sensor_delay",
      .subsystem = Subsystem::sensor,
      .rigs = every_rig,
      .parameters = {{{.name = "delay",
                       .unit = "s",
                       .lower = 0.0,
                       .upper = 0.5,
                       .starts = {.scale = scales::millisecond, .factors = {0.3, 1.0, 3.0, 10.0, 30.0}}}}},
      .equation = "that channel alone is late",
      .shows = "this channel alone lags in proportion to frequency, at unchanged amplitude",
      .linearisation = Linearisation::exact,
      .lateness = Lateness::delay};
  static constexpr auto values = std::array{&SensorDelay::delay};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.delay = delay; }
};

}  // namespace model
