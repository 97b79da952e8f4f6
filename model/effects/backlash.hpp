// Free play between the suspension and its component.
#pragma once

#include "model/effects/effect.hpp"
#include "model/places.hpp"

namespace model {

/// Dead zone before everything but the top mount.
///
///   e = dz_b − g/2 sgn(dz_b) beyond |dz_b| > g/2, else 0;   ė = ḋz_b there, else 0
///
/// Inside the free play the component sees neither deflection nor velocity.
template <class S>
struct Backlash {
  S gap{};  ///< g [m], whole width

  static constexpr EffectCard<1> card{
      "backlash",
      Place::suspension,
      RigKinds(RigKind::quarter_car, RigKind::hil, RigKind::component_bench),
      false,
      {{{"gap", "m", 0.0, 0.2}}},
      "the component sees dz_b with a dead zone of total width gap: 0 within ±gap/2",
      "no force around the middle position, knocks where the play ends; small excitation never reaches the component"};
  static constexpr auto values = std::array{&Backlash::gap};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.free_play += gap; }
};

}  // namespace model
