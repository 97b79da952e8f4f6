// Stops at the ends of the suspension travel.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Linear stops beyond a free travel, the same to both sides, with a sharp corner.
///
///   F_s += k max(0, |dz_b| − s₀) sgn(dz_b)
template <class S>
struct BumpStop {
  S clearance{};  ///< s₀ [m], free travel to each side
  S stiffness{};  ///< k [N/m] of a stop

  static constexpr EffectCard<2> card{
      .name = "bump_stop",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "clearance",
                       .unit = "m",
                       .lower = 0.0,
                       .upper = 0.5,
                       .starts = {.scale = scales::deflection_peak, .factors = {0.3, 0.5, 0.7, 0.85}}},
                      {.name = "stiffness",
                       .unit = "N/m",
                       .lower = 0.0,
                       .upper = 1e8,
                       .starts = {.scale = scales::stiffness, .factors = {0.3, 3.0}}}}},
      .equation = "F_s += stiffness · max(0, |dz_b| − clearance) · sgn(dz_b)",
      .shows = "extra force at large deflections only, from a sharp corner on, the same to both sides",
      .linearisation = Linearisation::left_out,
      .corner = Corner::stop,
      .force = {Over::deflection},
      .words = {.text = "stiffens from # mm on",
                .figures = {{{[](const double* v, double /*damping*/) { return 1e3 * v[0]; }}}}}};
  static constexpr auto values = std::array{&BumpStop::clearance, &BumpStop::stiffness};

  [[nodiscard]] constexpr S suspension_force(S deflection, S /*velocity*/) const {
    return select(deflection > clearance, stiffness * (deflection - clearance),
                  select(deflection < -clearance, stiffness * (deflection + clearance), S(0)));
  }
};

}  // namespace model
