// Fits the tolerated parameters of a rig description to recordings.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host_sim/comparison/comparison.hpp"

namespace host_sim {

/// All parameters under [tolerance], each as a factor on its described value:
///
///   (1)  min Σ nrmse²   over channels and recordings,   1 − tolerance ≤ factor ≤ 1 + tolerance,   factor ≥ 0.001
///
/// by the workbench's one solver (least_squares/). The best of three starts wins: as described, half way to the lower
/// bounds, half way to the upper ones.
struct Refit {
  model::RigParameters<double> rig;
  std::map<std::string, double> parameters;        ///< fitted, by path
  std::vector<std::string> at_bound;               ///< paths of those that ended at a bound
  double pooled_before = 0.0, pooled_after = 0.0;  ///< √(mean of nrmse²) over channels and recordings
};
/// `progress` is called with an upper bound of the share of the work that is done, and the pooled error so far.
/// InputError where no parameter is free, nothing moves in the recordings, or no simulation stays finite.
[[nodiscard]] Refit refit(const firmware::RigDescription& description, const std::vector<ComparedRecording>& recordings,
                          const std::function<void(double share, double pooled_error)>& progress = {});

}  // namespace host_sim
