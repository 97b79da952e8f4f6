// Viscous drag of the wheel's guide.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Linear drag between wheel and the rig's frame, on its absolute velocity.
///
///   m_w z̈_w = … − c ż_w
template <class S>
struct WheelGuideDamping {
  S damping{};  ///< c [N s/m]

  static constexpr EffectCard<1> card{
      .name = "wheel_guide_damping",
      .subsystem = Subsystem::wheel_guide,
      .rigs = RigKinds(RigKind::quarter_car),
      .parameters = {{{.name = "damping",
                       .unit = "N s/m",
                       .lower = 0.0,
                       .upper = 1e6,
                       .starts = {.scale = scales::damping, .factors = {0.01, 0.1}}}}},
      .equation = "m_w z̈_w = … − damping · ż_w",
      .shows = "the wheel's balance misses a force proportional to its absolute velocity",
      .linearisation = Linearisation::exact};
  static constexpr auto values = std::array{&WheelGuideDamping::damping};

  constexpr void act_on(Guides<S>& guides) const { guides.wheel_damping += damping; }
};

}  // namespace model
