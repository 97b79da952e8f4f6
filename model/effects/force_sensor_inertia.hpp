// The mass between the wheel-load sensor and the wheel spring.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Inertia force of what the sensor carries along with the foot point.
///
///   F_w,measured = F_w + m z̈_r
///
/// Source: second rig of the TU Darmstadt study, whose wheel load read wrong because of it.
template <class S>
struct ForceSensorInertia {
  S mass{};  ///< m [kg]

  static constexpr EffectCard<1> card{
      "force_sensor_inertia",
      Place::sensor,
      RigKinds(RigKind::quarter_car),
      false,
      {{{"mass", "kg", 0.0, 100.0}}},
      "F_w,measured = F_w + mass · z̈_r",
      "the wheel-load sensor departs from k_t dz_w in proportion to the foot point's acceleration, so with the square "
      "of frequency; the soft sensor k_t dz_w agrees with the model"};
  static constexpr auto values = std::array{&ForceSensorInertia::mass};

  constexpr void act_on(WheelLoadSensor<S>& sensor) const { sensor.mass_beyond += mass; }
};

}  // namespace model
