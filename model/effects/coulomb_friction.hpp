// Dry friction in the suspension component.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Coulomb friction parallel to spring, damper and FDVA.
///
///   F_s += F_r sgn(ḋz_b)        and, sticking, whatever of |F| ≤ F_r keeps ḋz_b = 0
///
/// The law is sharp. Where the deflection is free to move the step solves it implicitly (FrictionContacts); where it is
/// prescribed (test machine) the force follows the sign of the prescribed velocity.
template <class S>
struct CoulombFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      "coulomb_friction",
      Place::suspension,
      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
      false,
      {{{"force", "N", 0.0, 20e3}}},
      "F_s += force · sgn(ḋz_b)",
      "a force step at every reversal of the suspension deflection, independent of speed; small excitation sticks"};
  static constexpr auto values = std::array{&CoulombFriction::force};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.dry_friction += force; }
};

}  // namespace model
