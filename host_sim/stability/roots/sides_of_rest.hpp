// A rig that rests on a kink: the two smooth rigs on its sides.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/rig/rig_parameters.hpp"

namespace host_sim::stability {

/// A rig as it is on one side of its rest: smooth there, with the slopes of that side.
struct SideOfRest {
  std::string name;  ///< "dz_b above rest"; empty: the rig is smooth at rest
  model::RigParameters<double> rig;
};

/// A lever whose ratio has another slope above its rest than below, and a damper with two slopes, have no slope at
/// rest. A small motion has one slope on one side and another on the other; the rig is stable where both are. One entry
/// for a smooth rig, two for a kink, four for both. A damper whose softer side would drive counts with its mean.
[[nodiscard]] std::vector<SideOfRest> sides_of_rest(const model::RigParameters<double>& rig);

/// What was found on one side.
struct FoundOnSide {
  std::string name;
  bool stable{};
  std::optional<double> delay_left{};  ///< [s]
};

}  // namespace host_sim::stability
