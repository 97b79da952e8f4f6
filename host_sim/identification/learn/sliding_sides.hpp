// The difference between the forces of elastic sliders in compression and in rebound.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/identification/learn/learned_law.hpp"
#include "host_sim/identification/prepare/recording_window.hpp"

namespace host_sim::identification {

/// With the same force either way, sliders hold only half of the sum of both: what a lopsided damper does more on one
/// side stands in what is left. A pass is a stretch of samples in which the law is beyond `thresholds::sliding` of its
/// largest force on one side; F_+ and F_−: means of the measured force over the passes of a side, each pass one value,
///
///   (1)  more = 100 (−F_−/F_+ − 1) %
///
/// with 1.96 standard errors of that ratio, from how the passes of a side differ. An offset of the force,
///
///   (2)  (F_+ + F_−)/2
///
/// looks the same. nullopt: a side has fewer than thresholds::fewest_passes, or the interval holds 0.
struct SlidingSides {
  LawNumber more;
  double offset;  ///< (2) [N]
};
[[nodiscard]] std::optional<SlidingSides> sliding_sides(const std::vector<double>& law,
                                                        const std::vector<double>& measured, Window window,
                                                        double largest);

}  // namespace host_sim::identification
