// Dry friction of the FDVA piston.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Coulomb friction against the piston's travel. Oil flows only when the force of the coil spring exceeds it.
///
///   A_p Δp = F_c − F_r sgn(ẏ),   sticking while |F_c| ≤ F_r
template <class S>
struct SealFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      .name = "seal_friction",
      .subsystem = Subsystem::fdva,
      .rigs = every_rig,
      .needs_fdva = true,
      .parameters = {{{.name = "force",
                       .unit = "N",
                       .lower = 0.0,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.01, 0.03, 0.1, 0.3}}}}},
      .equation = "Coulomb friction on the FDVA piston: F_c = … + force · sgn(ẏ)",
      .shows = "the absorber sticks at small excitation: its resonance appears at large amplitudes only",
      .linearisation = Linearisation::left_out,
      .corner = Corner::sticking};
  static constexpr auto values = std::array{&SealFriction::force};

  constexpr void act_on(Piston<S>& piston) const { piston.dry_friction += force; }
};

}  // namespace model
