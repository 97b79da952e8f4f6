// Dry friction of the body's guide.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Coulomb friction between body and the rig's frame, on its absolute velocity.
///
///   m_b z̈_b = … − F_r sgn(ż_b)
template <class S>
struct BodyGuideFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      .name = "body_guide_friction",
      .subsystem = Subsystem::body_guide,
      .rigs = RigKinds(RigKind::quarter_car),
      .parameters = {{{.name = "force",
                       .unit = "N",
                       .lower = 0.0,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.01, 0.03, 0.1, 0.3}}}}},
      .equation = "m_b z̈_b = … − force · sgn(ż_b)",
      .shows = "a force step at every reversal of the body's absolute velocity; flat-topped phases at small excitation",
      .linearisation = Linearisation::left_out,
      .corner = Corner::sticking};
  static constexpr auto values = std::array{&BodyGuideFriction::force};

  constexpr void act_on(Guides<S>& guides) const { guides.body_dry_friction += force; }
};

}  // namespace model
