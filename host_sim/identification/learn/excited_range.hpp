// The range of velocities and deflections that the recordings excite at a place.
#pragma once

#include <optional>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// Of x over the fitted windows, as a hypothesis simulates it: where a law was seen, and where it is only continued. It
/// holds 0, where every law begins.
struct ExcitedRange {
  double lowest = 0.0, highest = 0.0;  ///< without thresholds::rarely_reached of the samples at each end
  double rms = 0.0;
  double farthest = 0.0;  ///< largest |x| of all that is recorded, held out or not

  [[nodiscard]] double largest() const { return highest > -lowest ? highest : -lowest; }
};
/// nullopt: the recordings do not move there.
[[nodiscard]] std::optional<ExcitedRange> excited_range(const IdentificationProblem& problem,
                                                        const Hypothesis& hypothesis, CurvePlace place, CurveOver over);

/// x(t) of one recording at a place, sample by sample.
[[nodiscard]] std::vector<double> motion_at(const PreparedRecording& recording, const Response& channels,
                                            CurvePlace place, CurveOver over);

}  // namespace host_sim::identification
