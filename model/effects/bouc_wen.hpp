// Hysteresis that does not depend on the rate.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"
#include "model/numerics/hysteresis_path.hpp"

namespace model {

/// Bouc–Wen element parallel to spring, damper and FDVA, with exponent n = 1: stiff after a reversal, then yielding
/// towards ± F_h.
///
///   (1)  F_s += u,   u̇ = k ḋz_b − β |ḋz_b| u − γ ḋz_b |u|
///   (2)  β + γ = k/F_h,   β − γ = s k/F_h
///
/// s = 1 is Dahl's friction. LuGre's, whose limit falls with velocity, was found as 0.80 ± 0.17 (its lookalike: 14 of
/// 18 recordings, rigtwin_truth law:KIND:lugre_friction 3001 … 3006). The element gives no energy where s ≥ 0.
///
/// With a = u sgn(ḋz_b), (1) is HysteresisPath: r = k/F_h while loading, s k/F_h while unloading. Source: Ismail,
/// Ikhouane, Rodellar, The hysteresis Bouc–Wen model, a survey, Arch. Comput. Methods Eng. 2009.
template <class S>
struct BoucWen {
  S stiffness{};  ///< k [N/m] after a reversal
  S force{};      ///< F_h [N]
  S unloading{};  ///< s [1]; 0: back along the stiffness k, straight

  static constexpr EffectCard<3> card{
      .name = "bouc_wen",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "stiffness",
                       .unit = "N/m",
                       .lower = 0.0,
                       .upper = 1e7,
                       .starts = {.scale = scales::stiffness, .factors = {0.3, 3.0}}},
                      {.name = "force",
                       .unit = "N",
                       .lower = 1e-3,
                       .upper = 20e3,
                       .starts = {.scale = scales::force, .factors = {0.05, 0.3}}},
                      {.name = "unloading",
                       .unit = "1",
                       .lower = -3.0,
                       .upper = 3.0,
                       .starts = {.scale = scales::unit, .factors = {0.3}},
                       .lookalike = {"friction with bristles (Dahl, LuGre)", 0.8, 0.17, 3.0}}}},
      .equation =
          "F_s += u, u̇ = stiffness · (ḋz_b − (1 + unloading)/2 · |ḋz_b| u/force − (1 − unloading)/2 · ḋz_b "
          "|u|/force)",
      .shows =
          "rounded loops of force over deflection whose height does not depend on frequency: rubber, cables, leaves",
      .linearisation = Linearisation::tangent,
      .imitates = true,
      .words = {.text = "hysteresis of # N independent of frequency",
                .figures = {{{[](const double* v, double /*damping*/) { return v[1]; }}}}}};
  static constexpr auto values = std::array{&BoucWen::stiffness, &BoucWen::force, &BoucWen::unloading};

  /// u after a travel of the deflection [m].
  [[nodiscard]] constexpr S force_after(S u, S travel) const {
    const S loading = stiffness / force;
    return HysteresisPath<S>{stiffness, loading, unloading * loading}.force_after(u, travel);
  }
  [[nodiscard]] constexpr Tangent<S> tangent() const { return {.stiffness = stiffness}; }
};

}  // namespace model
