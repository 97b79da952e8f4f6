// More damping in the suspension component.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Linear damping parallel to spring, damper and FDVA.
///
///   F_s += b ḋz_b
template <class S>
struct ViscousDamping {
  S damping{};  ///< b [N s/m]

  static constexpr EffectCard<1> card{
      "viscous_damping",
      Place::suspension,
      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
      false,
      {{{"damping", "N s/m", 0.0, 1e6}}},
      "F_s += damping · ḋz_b",
      "a force in phase with the deflection velocity, proportional to frequency and amplitude"};
  static constexpr auto values = std::array{&ViscousDamping::damping};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.damping += damping; }
};

}  // namespace model
