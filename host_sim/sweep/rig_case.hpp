// One case of a sweep, computed.
#pragma once

#include <string>

#include "host_sim/sweep/sweep_plan.hpp"

namespace host_sim::sweep {

/// Drives the rig of a case over its road through the firmware, as `rigtwin simulate` does, and returns its result
/// line:
///
///   {"id", "seed", each setting, "ended_by", "samples", then "rms_", "lowest_", "highest_" CHANNEL of each channel
///   [SI]}
///
/// A case that cannot be driven to its end (parameters that are no rig, a run that the firmware stops) is a result too:
/// the line has "failed" with the reason in the place of the numbers. No number of a line is infinite or NaN.
[[nodiscard]] std::string result_line(const SweepPlan& plan, std::uint64_t id);

}  // namespace host_sim::sweep
