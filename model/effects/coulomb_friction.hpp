// Dry friction in the suspension component.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Coulomb friction parallel to spring, damper and FDVA.
///
///   F_s += F_r sgn(ḋz_b)        while sticking, the force |F| ≤ F_r that keeps ḋz_b = 0
///
/// The law is sharp. Where the deflection is free to move the step solves it implicitly (FrictionContacts); where it is
/// prescribed (test machine) the force follows the sign of the prescribed velocity.
template <class S>
struct CoulombFriction {
  S force{};  ///< F_r [N]

  static constexpr EffectCard<1> card{
      .name = "coulomb_friction",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "force",
                       .unit = "N",
                       .lower = 0.0,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.01, 0.03, 0.1, 0.3}}}}},
      .equation = "F_s += force · sgn(ḋz_b)",
      .shows =
          "a force step at every reversal of the suspension deflection, independent of speed; small excitation sticks",
      .linearisation = Linearisation::left_out,
      .corner = Corner::sticking,
      .force = {Over::velocity, Form::power, 0.0},
      .words = {.text = "dry friction of # N",
                .figures = {{{[](const double* v, double /*damping*/) { return v[0]; }}}}}};
  static constexpr auto values = std::array{&CoulombFriction::force};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.dry_friction += force; }
};

}  // namespace model
