// Relaxing spring (Maxwell branch).
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Maxwell branch parallel to spring, damper and FDVA.
///
///   F_s += k_r (dz_b − x),   T ẋ = dz_b − x
template <class S>
struct Relaxation {
  S stiffness{};      ///< k_r [N/m]
  S time_constant{};  ///< T [s]

  static constexpr EffectCard<2> card{
      .name = "relaxation",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "stiffness",
                       .unit = "N/m",
                       .lower = 0.0,
                       .upper = 1e8,
                       .starts = {.scale = scales::stiffness, .factors = {0.05, 0.3}}},
                      {.name = "time_constant",
                       .unit = "s",
                       .lower = 1e-5,
                       .upper = 100.0,
                       .starts = {.scale = scales::millisecond, .factors = {2.0, 10.0, 50.0, 250.0}}}}},
      .equation = "F_s += stiffness · (dz_b − x), T ẋ = dz_b − x",
      .shows =
          "stiffness that rises by `stiffness` around the frequency 1/(2πT), with losses "
          "there: rubber, or a gas spring's heat transfer",
      .linearisation = Linearisation::exact,
      .force = {.form = Form::relaxing},
      .words = {.text = "relaxes within # ms",
                .figures = {{{[](const double* v, double /*damping*/) { return 1e3 * v[1]; }, 2}}}}};
  static constexpr auto values = std::array{&Relaxation::stiffness, &Relaxation::time_constant};

  constexpr void act_on(SuspensionComponent<S>& suspension) const {
    suspension.relaxing_stiffness = stiffness;
    suspension.relaxation_time = time_constant;
  }
};

}  // namespace model
