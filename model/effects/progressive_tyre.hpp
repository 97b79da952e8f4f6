// Tyre whose stiffness changes with deflection.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Symmetric progression of the tyre or wheel spring.
///
///   F_w += k₃ dz_w³
template <class S>
struct ProgressiveTyre {
  S cubic_stiffness{};  ///< k₃ [N/m³], either sign

  static constexpr EffectCard<1> card{
      .name = "progressive_tyre",
      .subsystem = Subsystem::tyre,
      .rigs = RigKinds(RigKind::quarter_car, RigKind::hil),
      .parameters = {{{.name = "cubic_stiffness",
                       .unit = "N/m³",
                       .lower = -1e12,
                       .upper = 1e12,
                       .starts = {.scale =
                                      [](const MotionScales& s) {
                                        return scales::tyre_stiffness(s) / (s.tyre_deflection * s.tyre_deflection);
                                      },
                                  .factors = {0.03, -0.03}}}}},
      .equation = "F_w += cubic_stiffness · dz_w³",
      .shows = "tyre stiffness that changes with the square of its deflection; third harmonic in the wheel load",
      .linearisation = Linearisation::left_out,
      .force = {Over::deflection, Form::power, 3.0},
      .words = {.text = "stiffens with |x|^3",
                .otherwise = "softens with |x|^3",
                .figures = {{{[](const double* v, double /*damping*/) { return v[0]; }}}}}};
  static constexpr auto values = std::array{&ProgressiveTyre::cubic_stiffness};

  /// What the tyre gives once this law is added to `force`, the force of all laws before it [N].
  [[nodiscard]] constexpr S tyre_force(S force, S deflection, S /*static_load*/) const {
    return force + cubic_stiffness * deflection * deflection * deflection;
  }
};

}  // namespace model
