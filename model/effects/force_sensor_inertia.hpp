// Mass between the wheel-load sensor and the wheel spring.
#pragma once

#include <algorithm>

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Inertia force of the mass that moves with the foot point in front of the sensor.
///
///   F_w,measured = F_w + m z̈_r
///
/// Source: second rig of the TU Darmstadt study, whose wheel load read wrong because of it.
template <class S>
struct ForceSensorInertia {
  S mass{};  ///< m [kg]

  static constexpr EffectCard<1> card{
      .name = "force_sensor_inertia",
      .subsystem = Subsystem::sensor,
      .rigs = RigKinds(RigKind::quarter_car),
      .parameters = {{{.name = "mass",
                       .unit = "kg",
                       .lower = 0.0,
                       .upper = 100.0,
                       .starts = {.scale =
                                      [](const MotionScales& s) {
                                        return s.tyre_force / std::max(s.foot_acceleration, scales::least);
                                      },
                                  .factors = {0.01, 0.1}}}}},
      .equation = "F_w,measured = F_w + mass · z̈_r",
      .shows =
          "the wheel-load sensor departs from k_t dz_w in proportion to the foot point's acceleration, so with the "
          "square "
          "of frequency; the soft sensor k_t dz_w agrees with the model",
      .linearisation = Linearisation::outside};
  static constexpr auto values = std::array{&ForceSensorInertia::mass};

  constexpr void act_on(WheelLoadSensor<S>& sensor) const { sensor.mass_beyond += mass; }
};

}  // namespace model
