// What a solution starts from.
#pragma once

#include <functional>
#include <vector>

namespace host_sim::replicate {

/// What a solution starts from.
struct SolveInput {
  std::vector<std::vector<double>> offset{};  ///< by which the rig's answer differs from the model's; empty: nothing
  std::vector<double> start{};                ///< a drive that is near; empty: the inverse of the linear rig
};

using SolveProgress = std::function<void(double share, double error)>;

}  // namespace host_sim::replicate
