// A tyre that stiffens, or softens, with deflection.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Symmetric progression of the tyre or wheel spring.
///
///   F_w += k₃ dz_w³
template <class S>
struct ProgressiveTyre {
  S cubic_stiffness{};  ///< k₃ [N/m³], either sign

  static constexpr EffectCard<1> card{
      "progressive_tyre",
      Place::tyre,
      RigKinds(RigKind::quarter_car, RigKind::hil),
      false,
      {{{"cubic_stiffness", "N/m³", -1e12, 1e12}}},
      "F_w += cubic_stiffness · dz_w³",
      "tyre stiffness that changes with the square of its deflection; third harmonic in the wheel load"};
  static constexpr auto values = std::array{&ProgressiveTyre::cubic_stiffness};

  /// What the tyre gives once this law is added to `force`, the force of all laws before it [N].
  [[nodiscard]] constexpr S tyre_force(S force, S deflection, S /*static_load*/) const {
    return force + cubic_stiffness * deflection * deflection * deflection;
  }
};

}  // namespace model
