// The result of a stability analysis in one sentence.
#pragma once

#include <string>

#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/over_amplitude.hpp"

namespace host_sim::stability {

/// "stable, 5.254 ms of delay left"; "unstable at 13.43 Hz, doubling every 0.32 s, stable with 2.246 ms less delay"
[[nodiscard]] std::string verdict(const StabilityAnalysis& analysis);

/// "limit cycle of 12.3 mm at 13.1 Hz: smaller oscillations grow to it, larger ones decay to it"
[[nodiscard]] std::string in_words(const LimitCycle& cycle);

}  // namespace host_sim::stability
