// Viscous drag of the body's guide.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Linear drag between body and the rig's frame, on its absolute velocity.
///
///   m_b z̈_b = … − c ż_b
template <class S>
struct BodyGuideDamping {
  S damping{};  ///< c [N s/m]

  static constexpr EffectCard<1> card{
      .name = "body_guide_damping",
      .subsystem = Subsystem::body_guide,
      .rigs = RigKinds(RigKind::quarter_car),
      .parameters = {{{.name = "damping",
                       .unit = "N s/m",
                       .lower = 0.0,
                       .upper = 1e6,
                       .starts = {.scale = scales::damping, .factors = {0.01, 0.1}}}}},
      .equation = "m_b z̈_b = … − damping · ż_b",
      .shows = "the body's balance misses a force proportional to its absolute velocity",
      .linearisation = Linearisation::exact};
  static constexpr auto values = std::array{&BodyGuideDamping::damping};

  constexpr void act_on(Guides<S>& guides) const { guides.body_damping += damping; }
};

}  // namespace model
