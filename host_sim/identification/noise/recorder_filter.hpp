// Low-passes of the recorder, as the colours of the channels' noises show them.
#pragma once

#include <vector>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// Channels whose noise is behind the same low-pass.
struct RecorderFilter {
  std::vector<model::Channel> channels;
  int order = 1;
  bool digital = false;     ///< computed from the samples
  double corner = 0.0;      ///< [Hz] mean of the channels' corners, weighted by their certainty
  double half_width = 0.0;  ///< [Hz] of its 95 % interval
};

/// The low-passes of the noises. A channel belongs to a filter where its noise is coloured in each recording, its
/// corner is known to thresholds::corner_known, order and kind are the same, and the corners agree within their
/// intervals or by the share `alike`. The channel that drives and what is fused with it are looked at, too; a command
/// has no noise.
[[nodiscard]] std::vector<RecorderFilter> recorder_filters(const IdentificationProblem& problem, double alike);

/// True if the noise of a channel tells whether the channel is behind a low-pass: in every recording its level is
/// known, and it is white or has a known corner.
[[nodiscard]] bool shows_its_colour(const IdentificationProblem& problem, model::Channel channel);

}  // namespace host_sim::identification
