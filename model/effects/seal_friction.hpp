// Dry friction of the absorber's piston.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Coulomb friction against the piston's travel; the coil spring must overcome it before oil flows.
///
///   A_p Δp = F_c − F_r sgn(ẏ),   sticking while |F_c| ≤ F_r
template <class S>
struct SealFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      "seal_friction",
      Place::fdva,
      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
      true,
      {{{"force", "N", 0.0, 20e3}}},
      "Coulomb friction on the FDVA piston: F_c = … + force · sgn(ẏ)",
      "the absorber sticks at small excitation: its resonance appears at large amplitudes only"};
  static constexpr auto values = std::array{&SealFriction::force};

  constexpr void act_on(Piston<S>& piston) const { piston.dry_friction += force; }
};

}  // namespace model
