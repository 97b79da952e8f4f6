// The shape of an effect of the catalogue, in the words that learned laws have.
#pragma once

#include <string>

#include "firmware/description/values/effects_by_name.hpp"

namespace host_sim::identification {

/// Of effects that are a law of force; empty for others. `rig`: whose stiffness and damping the effect adds to.
///
/// | effect               | words                                                                  |
/// | -------------------- | ---------------------------------------------------------------------- |
/// | asymmetric_damper    | "rebound 12 % harder than compression": slopes b ∓ ½ difference         |
/// | stribeck_friction    | "breaks away at 85 N, falls to 60 N by 20 mm/s (Stribeck)": 98 % of     |
/// |                      | the fall of a Gaussian, at twice its velocity                           |
/// | position_ripple      | "ripples every 5 mm by 12 N (cogging)": amplitude √(sine² + cosine²)    |
/// | bouc_wen             | "hysteresis of 62 N independent of frequency"                           |
/// | hardening_hysteresis | "hysteresis independent of frequency, twice as stiff under 170 N"       |
/// | relaxation           | "relaxes within 20 ms": its time constant                               |
/// | bump_stop            | "stiffens from 31 mm on"                                                |
/// | progressive_spring,  | "stiffens with |x|^3", "softens …"                                      |
/// | progressive_tyre     |                                                                        |
/// | quadratic_damping    | "grows with |v|^2"                                                      |
/// | coulomb_friction     | "dry friction of 34 N"                                                  |
[[nodiscard]] std::string shape_words(const firmware::PlacedEffect& effect, const model::RigParameters<double>& rig);

}  // namespace host_sim::identification
