// A force that repeats along the travel.
#pragma once

#include <cmath>

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"
#include "model/numerics/elementary.hpp"

namespace model {

/// Ripple over the deflection, parallel to spring, damper and FDVA: cogging of a linear motor, teeth of a rack, balls
/// of a guide.
///
///   F_s += a sin(2π dz_b/λ) + b (cos(2π dz_b/λ) − 1)
///
/// The amplitude is √(a² + b²); a and b say where along the travel the ripple stands. At rest it is 0, as every force
/// that counts from the static equilibrium.
template <class S>
struct PositionRipple {
  S period{};  ///< λ [m]
  S sine{};    ///< a [N]
  S cosine{};  ///< b [N]

  static constexpr EffectCard<3> card{
      .name = "position_ripple",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "period",
                       .unit = "m",
                       .lower = 1e-6,
                       .upper = 1.0,
                       .starts = {.scale = scales::ripple_period, .factors = {1.0}},
                       .kept_within = 0.2},
                      {.name = "sine",
                       .unit = "N",
                       .lower = -20e3,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.01, -0.01}}},
                      {.name = "cosine",
                       .unit = "N",
                       .lower = -20e3,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.01, -0.01}}}}},
      .equation = "F_s += sine · sin(2π dz_b/period) + cosine · (cos(2π dz_b/period) − 1)",
      .shows = "a force that repeats every `period` of the deflection, whatever the speed",
      .linearisation = Linearisation::tangent,
      .force = {Over::deflection},
      .words = {.text = "ripples every # mm by # N (cogging)",
                .figures = {
                    {{[](const double* v, double /*damping*/) { return 1e3 * v[0]; }},
                     {[](const double* v, double /*damping*/) { return std::sqrt(v[1] * v[1] + v[2] * v[2]); }, 2}}}}};
  static constexpr auto values = std::array{&PositionRipple::period, &PositionRipple::sine, &PositionRipple::cosine};

  [[nodiscard]] constexpr S suspension_force(S deflection, S /*velocity*/) const {
    const Turn<S> turn = turned(deflection / period);
    return sine * turn.sine + cosine * turn.cosine_less_one;
  }
  [[nodiscard]] constexpr Tangent<S> tangent() const { return {.stiffness = S(6.283185307179586) * sine / period}; }
};

}  // namespace model
