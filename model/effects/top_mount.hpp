// An elastic mount in series with the component.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Spring in series with the component: between the suspension deflection d and the deflection e inside.
///
///   F_s = k_m (dz_b − e),   the component inside sees e and ė
template <class S>
struct TopMount {
  S stiffness{};  ///< k_m [N/m]

  static constexpr EffectCard<1> card{
      .name = "top_mount",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "stiffness",
                       .unit = "N/m",
                       .lower = 1e3,
                       .upper = 1e10,
                       .starts = {.scale = scales::stiffness, .factors = {3.0, 10.0, 30.0, 100.0}}}}},
      .equation = "a spring of this stiffness in series with the whole component",
      .shows =
          "the component's dynamic stiffness is reduced most where it is stiffest: above "
          "the absorber's frequency and at high velocity",
      .linearisation = Linearisation::exact};
  static constexpr auto values = std::array{&TopMount::stiffness};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.mount_stiffness = stiffness; }
};

}  // namespace model
