// Damping that grows with speed.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Turbulent losses parallel to spring, damper and FDVA.
///
///   F_s += c₂ ḋz_b |ḋz_b|
///
/// Source: orifice flow at high Reynolds number.
template <class S>
struct QuadraticDamping {
  S coefficient{};  ///< c₂ [N s²/m²]

  static constexpr EffectCard<1> card{"quadratic_damping",
                                      Place::suspension,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"coefficient", "N s²/m²", 0.0, 1e7}}},
                                      "F_s += coefficient · ḋz_b |ḋz_b|",
                                      "damping that grows with amplitude; odd harmonics of the deflection velocity"};
  static constexpr auto values = std::array{&QuadraticDamping::coefficient};

  [[nodiscard]] constexpr S suspension_force(S /*deflection*/, S velocity) const {
    return coefficient * velocity * (velocity < S(0) ? -velocity : velocity);
  }
};

}  // namespace model
