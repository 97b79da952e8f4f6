// A lever for small motions about rest.
#pragma once

#include "model/components/lever.hpp"
#include "model/rig/rig_parameters.hpp"

namespace model {

/// (1) and (2) of Lever, linear at d = 0:  s = i d,  F_s = i F + k_l d,  k_l = F₀ di/dd. Without a lever i = 1, k_l =
/// 0.
struct LeverAtRest {
  double ratio = 1.0;  ///< i(0)
  double stiffness{};  ///< k_l [N/m]
};

[[nodiscard]] inline LeverAtRest lever_at_rest(const RigParameters<double>& rig) {
  if (!rig.lever.any()) return {};
  const Lever<double> lever(rig.lever, rig.body.mass);
  return {lever.ratio(0.0), lever.load() * lever.slope(0.0)};
}

}  // namespace model
