// The stability border in a plane of two parameters.
#pragma once

#include <string_view>
#include <vector>

#include "host_sim/stability/map/stability_map.hpp"

namespace host_sim::stability {

/// The parameter behind the variable of an axis ("virtual_damping" is machine.virtual_damping). The rig must have it.
[[nodiscard]] double& parameter_of(model::RigParameters<double>& rig, std::string_view variable);

/// All stability borders within the plane of a map whose roots are known.
[[nodiscard]] std::vector<BoundaryCurve> boundary(const LoopFamily& family, const StabilityMap& map);

}  // namespace host_sim::stability
