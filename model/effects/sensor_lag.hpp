// First-order low-pass of a sensor.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// First-order low-pass of one channel, on signal plus noise, exact for a signal that moves on a cubic between
/// samples.
///
///   T ẏ + y = u
template <class S>
struct SensorLag {
  S time_constant{};  ///< T [s]

  static constexpr EffectCard<1> card{
      .name = "sensor_lag",
      .subsystem = Subsystem::sensor,
      .rigs = every_rig,
      .parameters = {{{.name = "time_constant",
                       .unit = "s",
                       .lower = 0.0,
                       .upper = 1.0,
                       .starts = {.scale = scales::millisecond, .factors = {0.3, 1.0, 3.0, 10.0, 30.0}}}}},
      .equation = "first-order low-pass in that channel",
      .shows = "this channel alone falls and lags above 1/(2πT); its noise is low-passed too",
      .linearisation = Linearisation::exact,
      .lateness = Lateness::lag};
  static constexpr auto values = std::array{&SensorLag::time_constant};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.lag = time_constant; }
};

}  // namespace model
