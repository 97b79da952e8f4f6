// The result of a stability analysis in one sentence.
#pragma once

#include <string>

#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/over_amplitude.hpp"

namespace host_sim::stability {

/// Of the loop that the controller runs, sampled and held; the continuous figure stands second:
/// "stable, 4.757 ms of delay left as sampled at 1000 Hz (5.254 ms without sampling and hold)"; "unstable at 13.41 Hz,
/// doubling every 0.24 s, stable with 2.74 ms less delay (2.246 ms less without sampling and hold)"
[[nodiscard]] std::string verdict(const StabilityAnalysis& analysis);

/// "limit cycle of 12.3 mm at 13.1 Hz: smaller oscillations grow to it, larger ones decay to it"
[[nodiscard]] std::string in_words(const LimitCycle& cycle);

}  // namespace host_sim::stability
