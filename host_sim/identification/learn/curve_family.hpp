// Which family of curves a free curve belongs to.
#pragma once

#include <vector>

#include "host_sim/identification/learn/curve_fit.hpp"

namespace host_sim::identification {

/// A family in the place of a free curve, and how much larger χ² is with it, as far as the curve's own quadratic form
/// (CurveFit::farther) tells without a simulation.
struct FamilyMember {
  PlacedLaw law;
  double farther = 0.0;
};

/// The best member of each family, nearest first (farther + SelectionCriterion::parameter for each of its values). The
/// values that are forces are solved for, the others searched on a grid. `beside_friction`: dry friction acts there, so
/// that it may fall with velocity.
[[nodiscard]] std::vector<FamilyMember> families_of(const CurveFit& curve, bool beside_friction);

}  // namespace host_sim::identification
