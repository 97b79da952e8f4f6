// Free play between the suspension and its component.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

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
      .name = "backlash",
      .subsystem = Subsystem::suspension,
      .rigs = every_rig,
      .parameters = {{{.name = "gap",
                       .unit = "m",
                       .lower = 0.0,
                       .upper = 0.2,
                       .starts = {.scale = scales::deflection, .factors = {0.03, 0.1, 0.3, 1.0}}}}},
      .equation = "the component sees dz_b with a dead zone of total width gap: 0 within ±gap/2",
      .shows =
          "no force around the middle position, knocks where the play ends; small excitation never reaches the "
          "component",
      .linearisation = Linearisation::left_out,
      .corner = Corner::free_play};
  static constexpr auto values = std::array{&Backlash::gap};

  constexpr void act_on(SuspensionComponent<S>& suspension) const { suspension.free_play += gap; }
};

}  // namespace model
