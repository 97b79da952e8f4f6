// Suspension spring whose stiffness changes with deflection.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Symmetric progression parallel to spring, damper and FDVA.
///
///   F_s += k₃ dz_b³
template <class S>
struct ProgressiveSpring {
  S cubic_stiffness{};  ///< k₃ [N/m³], either sign

  static constexpr EffectCard<1> card{
      .name = "progressive_spring",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "cubic_stiffness",
                       .unit = "N/m³",
                       .lower = -1e10,
                       .upper = 1e10,
                       .starts = {.scale =
                                      [](const MotionScales& s) {
                                        return scales::stiffness(s) / (s.deflection * s.deflection);
                                      },
                                  .factors = {0.03, -0.03}}}}},
      .equation = "F_s += cubic_stiffness · dz_b³",
      .shows = "stiffness that grows (or falls) with the square of the deflection; third harmonic of the deflection",
      .linearisation = Linearisation::left_out,
      .force = {Over::deflection, Form::power, 3.0},
      .words = {.text = "stiffens with |x|^3",
                .otherwise = "softens with |x|^3",
                .figures = {{{[](const double* v, double /*damping*/) { return v[0]; }}}}}};
  static constexpr auto values = std::array{&ProgressiveSpring::cubic_stiffness};

  [[nodiscard]] constexpr S suspension_force(S deflection, S /*velocity*/) const {
    return cubic_stiffness * deflection * deflection * deflection;
  }
};

}  // namespace model
