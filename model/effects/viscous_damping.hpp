// Additional linear damping of the suspension component.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Linear damping parallel to spring, damper and FDVA.
///
///   F_s += b ḋz_b
template <class S>
struct ViscousDamping {
  S damping{};  ///< b [N s/m]

  static constexpr EffectCard<1> card{
      .name = "viscous_damping",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "damping",
                       .unit = "N s/m",
                       .lower = 0.0,
                       .upper = 1e6,
                       .starts = {.scale = scales::damping, .factors = {0.01, 0.1}}}}},
      .equation = "F_s += damping · ḋz_b",
      .shows = "a force in phase with the deflection velocity, proportional to frequency and amplitude",
      .linearisation = Linearisation::exact,
      .force = {Over::velocity, Form::power, 1.0}};
  static constexpr auto values = std::array{&ViscousDamping::damping};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.damping += damping; }
};

}  // namespace model
