// Dry friction of the wheel's guide.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Coulomb friction between wheel and the rig's frame, on its absolute velocity.
///
///   m_w z̈_w = … − F_r sgn(ż_w)
template <class S>
struct WheelGuideFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      "wheel_guide_friction",
      Place::wheel_guide,
      RigKinds(RigKind::quarter_car),
      false,
      {{{"force", "N", 0.0, 20e3}}},
      "m_w z̈_w = … − force · sgn(ż_w)",
      "a force step at every reversal of the wheel's absolute velocity; flat-topped phases at small excitation"};
  static constexpr auto values = std::array{&WheelGuideFriction::force};

  constexpr void act_on(Guides<S>& guides) const { guides.wheel_dry_friction += force; }
};

}  // namespace model
