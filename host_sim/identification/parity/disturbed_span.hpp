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

/// The parts of a stretch in which a parity relation fails as nowhere else: a balance holds again as soon as a push
/// ends, while the motion that it left lasts on. They are the runs of blocks of thresholds::span_block whose rms is
/// above thresholds::span_deviations times the median block's, of that relation which has the loudest one; the loudest
/// first, without those of less than thresholds::span_share of its power. Empty: no relation fails there so much.
[[nodiscard]] std::vector<TimeSpan> disturbed_spans(const firmware::RigDescription& description,
                                                    const PreparedRecording& recording, const TimeSpan& within);

}  // namespace host_sim::identification
