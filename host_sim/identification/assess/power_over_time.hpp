// Residual power second by second: when a disagreement happens, beside in which band.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "host_sim/identification/estimate/residual_over_time.hpp"

namespace host_sim::identification {

/// Of one channel of one recording: Σ r²/n of each stretch, 1 for noise alone.
struct PowerOverTime {
  model::Channel channel;
  std::size_t recording;
  std::vector<double> from, to;      ///< of the stretches [s]
  std::vector<double> refit, after;  ///< tolerances refitted; effects added

  /// The stretch of time that holds the middle 80 % of what `refit` has beyond noise; the whole where it has nothing.
  [[nodiscard]] std::pair<double, double> middle() const;
  [[nodiscard]] double excess() const;  ///< Σ of max(refit − 1, 0)
};

/// By recording, then by channel.
[[nodiscard]] std::vector<PowerOverTime> power_over_time(const IdentificationProblem& problem, const Hypothesis& refit,
                                                         const Hypothesis& after);

}  // namespace host_sim::identification
