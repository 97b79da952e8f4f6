// Tests that uncertainty budgets are as wide as estimates scatter: rigs whose sensors, parameters and noise are drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace uncertainty_budget {

/// A linear rig with a known effect. In each draw
///
///   (1)  a sensor reads (1 + δ) y + o + noise, δ and o normal with the standard deviations of [calibration]
///   (2)  a tolerated parameter that is not fitted is uniform in its tolerance
///   (3)  effect and fitted parameters are as described, and are fitted to what was read; nothing is searched
struct Asked {
  std::string rig = "component_bench";  ///< or quarter_car
  std::size_t draws = 1000;
  std::uint64_t seed = 1;
  double duration = 8.0;    ///< [s]
  bool calibration = true;  ///< else the sensors are exact
  bool tolerances = true;   ///< else what is not fitted is exact
};

/// One number: estimated, or predicted by what was estimated.
struct Compared {
  std::string number;     ///< "suspension.stiffness", "rms of F"
  double spread = 0.0;    ///< standard deviation over the draws of what was found less what was drawn
  double bias = 0.0;      ///< its mean
  double combined = 0.0;  ///< of the budget, by one recording without errors but its noise
  std::string parts;      ///< of the budget: "calibration of F 68 %, noise 31 %"
};
[[nodiscard]] std::vector<Compared> compare(const Asked& asked);

}  // namespace uncertainty_budget
