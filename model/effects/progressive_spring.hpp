// A spring that stiffens, or softens, with deflection.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Symmetric progression parallel to spring, damper and FDVA.
///
///   F_s += k₃ dz_b³
template <class S>
struct ProgressiveSpring {
  S cubic_stiffness{};  ///< k₃ [N/m³], either sign

  static constexpr EffectCard<1> card{
      "progressive_spring",
      Place::suspension,
      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
      false,
      {{{"cubic_stiffness", "N/m³", -1e10, 1e10}}},
      "F_s += cubic_stiffness · dz_b³",
      "stiffness that grows (or falls) with the square of the deflection; third harmonic of the deflection"};
  static constexpr auto values = std::array{&ProgressiveSpring::cubic_stiffness};

  [[nodiscard]] constexpr S suspension_force(S deflection, S /*velocity*/) const {
    return cubic_stiffness * deflection * deflection * deflection;
  }
};

}  // namespace model
