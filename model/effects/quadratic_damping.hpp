// Damping in proportion to the square of the velocity.
#pragma once

#include <algorithm>

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Turbulent losses parallel to spring, damper and FDVA.
///
///   F_s += c₂ ḋz_b |ḋz_b|
///
/// Source: orifice flow at high Reynolds number.
template <class S>
struct QuadraticDamping {
  S coefficient{};  ///< c₂ [N s²/m²]

  static constexpr EffectCard<1> card{
      .name = "quadratic_damping",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "coefficient",
                       .unit = "N s²/m²",
                       .lower = 0.0,
                       .upper = 1e7,
                       .starts = {.scale =
                                      [](const MotionScales& s) {
                                        return scales::damping(s) / std::max(s.velocity, scales::least);
                                      },
                                  .factors = {0.03, 0.3}}}}},
      .equation = "F_s += coefficient · ḋz_b |ḋz_b|",
      .shows = "damping that grows with amplitude; odd harmonics of the deflection velocity",
      .linearisation = Linearisation::left_out,
      .force = {Over::velocity, Form::power, 2.0},
      .words = {.text = "grows with |v|^2"}};
  static constexpr auto values = std::array{&QuadraticDamping::coefficient};

  [[nodiscard]] constexpr S suspension_force(S /*deflection*/, S velocity) const {
    return coefficient * velocity * select(velocity < S(0), -velocity, velocity);
  }
};

}  // namespace model
