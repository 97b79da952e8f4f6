// Stops at the ends of the travel.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Linear stops beyond a free travel, the same to both sides, with a sharp corner.
///
///   F_s += k max(0, |dz_b| − s₀) sgn(dz_b)
template <class S>
struct BumpStop {
  S clearance{};  ///< s₀ [m], free travel to each side
  S stiffness{};  ///< k [N/m] of a stop

  static constexpr EffectCard<2> card{
      "bump_stop",
      Place::suspension,
      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
      false,
      {{{"clearance", "m", 0.0, 0.5}, {"stiffness", "N/m", 0.0, 1e8}}},
      "F_s += stiffness · max(0, |dz_b| − clearance) · sgn(dz_b)",
      "extra force at large deflections only, from a sharp corner on, the same to both sides"};
  static constexpr auto values = std::array{&BumpStop::clearance, &BumpStop::stiffness};

  [[nodiscard]] constexpr S suspension_force(S deflection, S /*velocity*/) const {
    if (deflection > clearance) return stiffness * (deflection - clearance);
    if (deflection < -clearance) return stiffness * (deflection + clearance);
    return S(0);
  }
};

}  // namespace model
