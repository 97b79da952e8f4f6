// A sensor that renews its value too seldom.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Sample and hold of one channel, on signal plus noise, renewed at the first sample and then every period. A
/// recording's own phase is unknown.
///
///   y(t) = u(t_r),   t_r = last renewal ≤ t
template <class S>
struct SensorHold {
  S period{};  ///< T_h [s]

  static constexpr EffectCard<1> card{"sensor_hold",
                                      Place::sensor,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"period", "s", 0.0, 1.0}}},
                                      "measured value renewed only every period, held between",
                                      "steps of equal length in this channel alone, late by half a period on average"};
  static constexpr auto values = std::array{&SensorHold::period};

  constexpr void act_on(SensorPath<S>& sensor) const { sensor.hold = period; }
};

}  // namespace model
