// A damper that is not the same in both directions.
#pragma once

#include <limits>

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Damping of two slopes, as the valves of a damper have them, around the damping described: half of the difference
/// more in compression, half of it less in rebound.
///
///   F_s += ½ Δ |ḋz_b|      slopes b_b + ½Δ for ḋz_b > 0, b_b − ½Δ for ḋz_b < 0
///
/// The mean of both slopes is the damping described, or viscous damping beside it. Source: Dixon, The Shock Absorber
/// Handbook, 2007, chapter 7.
template <class S>
struct AsymmetricDamper {
  S difference{};  ///< Δ [N s/m], compression less rebound

  static constexpr EffectCard<1> card{
      .name = "asymmetric_damper",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "difference",
                       .unit = "N s/m",
                       .lower = -1e6,
                       .upper = 1e6,
                       .starts = {.scale = scales::damping, .factors = {0.1, -0.1}}}}},
      .equation = "F_s += ½ difference · |ḋz_b|: slopes ± ½ difference around the damping described",
      .shows = "a force with the magnitude of the deflection velocity: its mean grows with the level, second harmonic",
      .linearisation = Linearisation::left_out,
      .imitates = true,
      .force = {Over::velocity, Form::two_slopes},
      .words = {.text = "rebound # % harder than compression",
                .otherwise = "rebound # % softer than compression",
                .figures = {{{[](const double* v, double damping) {
                                const double push = damping + 0.5 * v[0], pull = damping - 0.5 * v[0];
                                return push > 0.0 ? 100.0 * (pull / push - 1.0)
                                                  : std::numeric_limits<double>::quiet_NaN();
                              },
                              2}}}}};
  static constexpr auto values = std::array{&AsymmetricDamper::difference};

  [[nodiscard]] constexpr S suspension_force(S /*deflection*/, S velocity) const {
    return S(0.5) * difference * select(velocity < S(0), S(-velocity), velocity);
  }
};

}  // namespace model
