// Viscous drag of the body's guide.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Linear drag between body and the rig's frame, on its absolute velocity.
///
///   m_b z̈_b = … − c ż_b
template <class S>
struct BodyGuideDamping {
  S damping{};  ///< c [N s/m]

  static constexpr EffectCard<1> card{"body_guide_damping",
                                      Place::body_guide,
                                      RigKinds(RigKind::quarter_car),
                                      false,
                                      {{{"damping", "N s/m", 0.0, 1e6}}},
                                      "m_b z̈_b = … − damping · ż_b",
                                      "the body's balance misses a force proportional to its absolute velocity"};
  static constexpr auto values = std::array{&BodyGuideDamping::damping};

  constexpr void act_on(Guides<S>& guides) const { guides.body_damping += damping; }
};

}  // namespace model
