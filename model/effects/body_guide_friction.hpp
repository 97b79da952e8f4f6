// Dry friction of the body's guide.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Coulomb friction between body and the rig's frame, on its absolute velocity.
///
///   m_b z̈_b = … − F_r sgn(ż_b)
template <class S>
struct BodyGuideFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      "body_guide_friction",
      Place::body_guide,
      RigKinds(RigKind::quarter_car),
      false,
      {{{"force", "N", 0.0, 20e3}}},
      "m_b z̈_b = … − force · sgn(ż_b)",
      "a force step at every reversal of the body's absolute velocity; flat-topped phases at small excitation"};
  static constexpr auto values = std::array{&BodyGuideFriction::force};

  constexpr void act_on(Guides<S>& guides) const { guides.body_dry_friction += force; }
};

}  // namespace model
