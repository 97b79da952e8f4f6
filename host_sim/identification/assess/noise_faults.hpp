// Noise that is not what the rig description says.
#pragma once

#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// Faults of the recording that its noise shows:
///
///   noise_level   factor      a channel's rms ÷ what was declared; the mean over the recordings, weighted by their
///   errors noise_colour  corner_hz   channels behind a low-pass; one entry for those of one order whose corners agree
[[nodiscard]] std::vector<RecordingFault> noise_faults(const IdentificationProblem& problem);

}  // namespace host_sim::identification
