// When something acted on the rig from outside, as the balances between channels show it.
#pragma once

#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace host_sim::identification {

/// A stretch of time [s], as in the recording.
struct TimeSpan {
  double from, to;
};

/// The parity relations of a recording, each fitted to it once, and where they fail.
class Balances {
 public:
  Balances(const firmware::RigDescription& description, const PreparedRecording& recording);

  /// Whether the recorded channels make a relation at all.
  [[nodiscard]] bool can_be_drawn_up() const { return can_be_drawn_up_; }

  /// The parts of a stretch in which a relation fails as nowhere else: a balance holds again as soon as a push ends,
  /// while the motion that it left lasts on. They are the runs of blocks of thresholds::span_block whose rms is above
  /// thresholds::span_deviations times the median block's, of that relation which has the loudest one; the loudest
  /// first, without those of less than thresholds::span_share of its power. Empty: no relation fails there so much.
  [[nodiscard]] std::vector<TimeSpan> disturbed(const TimeSpan& within) const;

 private:
  double begin_, block_;  ///< [s]
  bool can_be_drawn_up_;
  /// By relation: the rms of its residual in each block, in units of the median block's; negative where samples miss.
  std::vector<std::vector<double>> sizes_;
};

}  // namespace host_sim::identification
