// Viscous drag of the wheel's guide.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Linear drag between wheel and the rig's frame, on its absolute velocity.
///
///   m_w z̈_w = … − c ż_w
template <class S>
struct WheelGuideDamping {
  S damping{};  ///< c [N s/m]

  static constexpr EffectCard<1> card{"wheel_guide_damping",
                                      Place::wheel_guide,
                                      RigKinds(RigKind::quarter_car),
                                      false,
                                      {{{"damping", "N s/m", 0.0, 1e6}}},
                                      "m_w z̈_w = … − damping · ż_w",
                                      "the wheel's balance misses a force proportional to its absolute velocity"};
  static constexpr auto values = std::array{&WheelGuideDamping::damping};

  constexpr void act_on(Guides<S>& guides) const { guides.wheel_damping += damping; }
};

}  // namespace model
