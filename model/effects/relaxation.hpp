// A spring that relaxes.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Maxwell branch parallel to spring, damper and FDVA.
///
///   F_s += k_r (dz_b − x),   T ẋ = dz_b − x
template <class S>
struct Relaxation {
  S stiffness{};      ///< k_r [N/m]
  S time_constant{};  ///< T [s]

  static constexpr EffectCard<2> card{"relaxation",
                                      Place::suspension,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"stiffness", "N/m", 0.0, 1e8}, {"time_constant", "s", 1e-5, 100.0}}},
                                      "F_s += stiffness · (dz_b − x), T ẋ = dz_b − x",
                                      "stiffness that rises by `stiffness` around the frequency 1/(2πT), with losses "
                                      "there: rubber, or a gas spring's heat transfer"};
  static constexpr auto values = std::array{&Relaxation::stiffness, &Relaxation::time_constant};

  constexpr void act_on(SuspensionComponent<S>& suspension) const {
    suspension.relaxing_stiffness = stiffness;
    suspension.relaxation_time = time_constant;
  }
};

}  // namespace model
