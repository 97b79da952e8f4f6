// Gain error of a sensor.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Scale error of one channel; its noise keeps its size.
///
///   y = g u
template <class S>
struct SensorGain {
  S gain{};  ///< g [1]

  static constexpr EffectCard<1> card{
      .name = "sensor_gain",
      .subsystem = Subsystem::sensor,
      .rigs = every_rig,
      .parameters = {{{.name = "gain",
                       .unit = "1",
                       .lower = -100.0,
                       .upper = 100.0,
                       .starts = {.scale = scales::unit, .factors = {1.02, 0.98}},
                       .neutral = 1.0}}},
      .equation = "measured = gain · true",
      .shows = "this channel alone is larger or smaller by one factor at every frequency and amplitude",
      .linearisation = Linearisation::exact};
  static constexpr auto values = std::array{&SensorGain::gain};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.gain = gain; }
};

}  // namespace model
