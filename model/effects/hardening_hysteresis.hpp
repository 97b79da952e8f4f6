// Hysteresis that stiffens as it loads.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"
#include "model/numerics/hysteresis_path.hpp"

namespace model {

/// Bouc–Wen element with β + γ < 0 parallel to spring, damper and FDVA, exponent n = 1: it does not yield, but becomes
/// stiffer the more it carries, and steeper still on the way back.
///
///   (1)  F_s += u,   u̇ = k ḋz_b − β |ḋz_b| u − γ ḋz_b |u|
///   (2)  β + γ = −k/F_h,   β − γ = s k/F_h
///
/// Loading has the stiffness k (1 + |u|/F_h), unloading k (1 + s |u|/F_h), whatever the rate. With s = 1 both are one
/// line, a spring; the element gives no energy where s ≥ 1. HysteresisPath with r = −k/F_h while loading, s k/F_h while
/// unloading. Source: as of BoucWen; the benchmark of Noël and Schoukens (Nonlinear system identification benchmarks,
/// 2016) is k = 5e4 N/m, F_h = 166.7 N, s = 6.33.
template <class S>
struct HardeningHysteresis {
  S stiffness{};  ///< k [N/m] without load
  S force{};      ///< F_h [N] under which it is twice as stiff
  S unloading{};  ///< s [1]

  static constexpr EffectCard<3> card{
      .name = "hardening_hysteresis",
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
                       .starts = {.scale = scales::force, .factors = {0.3, 3.0}}},
                      {.name = "unloading",
                       .unit = "1",
                       .lower = 1.0,
                       .upper = 20.0,
                       .starts = {.scale = scales::unit, .factors = {4.0}}}}},
      .equation =
          "F_s += u, u̇ = stiffness · ḋz_b · (1 + |u|/force) while |u| grows, · (1 + unloading · |u|/force) while "
          "it falls",
      .shows =
          "loops of force over deflection that get steeper towards their ends and whose area does not depend on "
          "frequency: wire-rope mounts, stacks of disc springs",
      .linearisation = Linearisation::tangent,
      .corner = Corner::reversal,
      .imitates = true,
      .words = {.text = "hysteresis independent of frequency, twice as stiff under # N",
                .figures = {{{[](const double* v, double /*damping*/) { return v[1]; }}}}}};
  static constexpr auto values =
      std::array{&HardeningHysteresis::stiffness, &HardeningHysteresis::force, &HardeningHysteresis::unloading};

  /// u after a travel of the deflection [m].
  [[nodiscard]] constexpr S force_after(S u, S travel) const {
    const S loading = stiffness / force;
    return HysteresisPath<S>{stiffness, -loading, unloading * loading}.force_after(u, travel);
  }
  [[nodiscard]] constexpr Tangent<S> tangent() const { return {.stiffness = stiffness}; }
};

}  // namespace model
