// Dry friction of the wheel's guide.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Coulomb friction between wheel and the rig's frame, on its absolute velocity.
///
///   m_w z̈_w = … − F_r sgn(ż_w)
template <class S>
struct WheelGuideFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      .name = "wheel_guide_friction",
      .subsystem = Subsystem::wheel_guide,
      .rigs = RigKinds(RigKind::quarter_car),
      .parameters = {{{.name = "force",
                       .unit = "N",
                       .lower = 0.0,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.01, 0.03, 0.1, 0.3}}}}},
      .equation = "m_w z̈_w = … − force · sgn(ż_w)",
      .shows =
          "a force step at every reversal of the wheel's absolute velocity; flat-topped phases at small excitation",
      .linearisation = Linearisation::left_out,
      .corner = Corner::sticking};
  static constexpr auto values = std::array{&WheelGuideFriction::force};

  constexpr void act_on(Guides<S>& guides) const { guides.wheel_dry_friction += force; }
};

}  // namespace model
