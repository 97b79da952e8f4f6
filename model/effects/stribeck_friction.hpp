// Dry friction that falls with velocity.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"
#include "model/numerics/elementary.hpp"

namespace model {

/// Dry friction parallel to spring, damper and FDVA that breaks away at (1 + e) F_c and slides at F_c.
///
///   F_s += F_c (1 + e exp(−(ḋz_b/v_s)²)) sgn(ḋz_b)
///   while sticking, the force |F| ≤ (1 + e) F_c that keeps ḋz_b = 0
///
/// Sticking is sharp, as that of Coulomb friction. The excess is bounded: what falls to a sixth of itself is no
/// friction. Source: Armstrong-Hélouvry, Dupont, Canudas de Wit, A survey of models for the control of machines with
/// friction, Automatica 1994, (4).
template <class S>
struct StribeckFriction {
  S sliding{};   ///< F_c [N]
  S excess{};    ///< e [1]: what breaking away takes more than sliding, relative to sliding
  S velocity{};  ///< v_s [m/s]

  static constexpr EffectCard<3> card{
      .name = "stribeck_friction",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "sliding",
                       .unit = "N",
                       .lower = 0.0,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.1}},
                       .from_contained = true},
                      {.name = "excess",
                       .unit = "1",
                       .lower = 0.0,
                       .upper = 3.0,
                       .starts = {.scale = scales::unit, .factors = {0.7}}},
                      {.name = "velocity",
                       .unit = "m/s",
                       .lower = 1e-4,
                       .upper = 0.1,
                       .starts = {.scale = [](const MotionScales& /*s*/) { return 0.01; },  // [m/s]
                                  .factors = {0.5, 3.0}}}}},
      .equation = "F_s += sliding · (1 + excess · exp(−(ḋz_b/velocity)²)) · sgn(ḋz_b)",
      .shows = "a force step at every reversal that falls as the deflection gets faster; jerks at the end of sticking",
      .linearisation = Linearisation::left_out,
      .corner = Corner::sticking,
      .contains = "coulomb_friction",
      .imitates = true,
      .force = {Over::velocity, Form::falling},
      .words = {.text = "breaks away at # N, falls to # N by # mm/s (Stribeck)",
                .figures = {{{[](const double* v, double /*damping*/) { return v[0] * (1.0 + v[1]); }},
                             {[](const double* v, double /*damping*/) { return v[0]; }},
                             {[](const double* v, double /*damping*/) { return 2e3 * v[2]; }, 2}}}}};
  static constexpr auto values =
      std::array{&StribeckFriction::sliding, &StribeckFriction::excess, &StribeckFriction::velocity};

  constexpr void act_on(SuspensionComponent<S>& suspension) const {
    suspension.dry_friction += sliding * (S(1) + excess);
  }
  /// What the friction falls by: beside that of the contact.
  [[nodiscard]] constexpr S suspension_force(S /*deflection*/, S speed) const {
    const S ratio = speed / velocity;
    const S fall = sliding * excess * (S(1) - decaying(ratio * ratio));
    return select(speed < S(0), fall, S(-fall));
  }
};

}  // namespace model
