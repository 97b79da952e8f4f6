// A solution by derivatives along the trajectory.
#pragma once

#include <vector>

#include "host_sim/replicate/band_inverse.hpp"
#include "host_sim/replicate/drive_limits.hpp"
#include "host_sim/replicate/drive_model.hpp"
#include "host_sim/replicate/solve_input.hpp"
#include "host_sim/replicate/target.hpp"

namespace host_sim::replicate {

struct TrajectorySolution {
  std::vector<double> drive;            ///< [m], within stroke, speed and acceleration
  DriveModel::Answer answer;            ///< of the model
  std::vector<double> error;            ///< as in Solution
  std::vector<double> error_unlimited;  ///< without limits; empty: no limit was in the way
  int rounds = 0;
};

/// Tracking has a filter of low order in place of a band and leaves out the machine's delay and the sensors. What that
/// leaves is made up outside of it: with t the target, d the offset, y the whole model, b the band, S the linear part of
/// the sensors,
///
///   (1)  t° = S⁻¹ (t − d)                    what Tracking follows at first
///   (2)  t° ← t° + S⁻¹ b (t − d − y(u))      until no gain is left
///
/// The rig without its corners is solved first. Then the rig with them is led along that motion by the feedback of the
/// rig without: that is near, and is solved. Limits: the solution without them is projected onto them
/// (LimitProjection); where that costs much, they enter the cost. The best drive found is kept.
[[nodiscard]] TrajectorySolution solve_along_trajectory(const DriveModel& model, const Target& target,
                                                        const BandInverse& inverse, const DriveLimits& limits,
                                                        const SolveInput& input, const SolveProgress& progress = {});

}  // namespace host_sim::replicate
