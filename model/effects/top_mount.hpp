// An elastic mount in series with the component.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Spring between the outside of the component, which moves with the suspension, and everything in it.
///
///   F_s = k_m (dz_b − e),   the component inside sees e and ė
template <class S>
struct TopMount {
  S stiffness{};  ///< k_m [N/m]

  static constexpr EffectCard<1> card{"top_mount",
                                      Place::suspension,
                                      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
                                      false,
                                      {{{"stiffness", "N/m", 1e3, 1e10}}},
                                      "a spring of this stiffness in series with the whole component",
                                      "the component's dynamic stiffness is reduced most where it is stiffest: above "
                                      "the absorber's frequency and at high velocity"};
  static constexpr auto values = std::array{&TopMount::stiffness};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.mount_stiffness = stiffness; }
};

}  // namespace model
