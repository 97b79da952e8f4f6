// Sample and hold of a sensor.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Sample and hold of one channel, on signal plus noise, renewed at the first sample and then every period. A
/// recording's own phase is unknown.
///
///   y(t) = u(t_r),   t_r = last renewal ≤ t
template <class S>
struct SensorHold {
  S period{};  ///< T_h [s]

  static constexpr EffectCard<1> card{
      .name = "sensor_hold",
      .subsystem = Subsystem::sensor,
      .rigs = every_rig,
      .parameters = {{{.name = "period",
                       .unit = "s",
                       .lower = 0.0,
                       .upper = 1.0,
                       .starts = {.read = Reading::renewal_period},
                       .fitted = false}}},
      .equation = "measured value renewed only every period, held between",
      .shows = "steps of equal length in this channel alone, late by half a period on average",
      .linearisation = Linearisation::left_out};
  static constexpr auto values = std::array{&SensorHold::period};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.hold = period; }
};

}  // namespace model
