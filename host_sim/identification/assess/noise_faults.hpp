// Noise that is not what the rig description says.
#pragma once

#include <string>
#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// Faults of the recording that its noise shows:
///
///   noise_level   factor      rms of a channel ÷ what was declared; mean of the recordings, weighted by their errors
///   noise_colour  corner_hz   channels behind a low-pass; one entry for those of one order whose corners agree
[[nodiscard]] std::vector<RecordingFault> noise_faults(const IdentificationProblem& problem);

/// One sentence for each channel without declared noise: the level that was estimated.
/// The constants that were taken off channels (comparison/static_value.hpp), of all recordings: "static_value", once a
/// channel.
[[nodiscard]] std::vector<RecordingFault> static_value_faults(const IdentificationProblem& problem);

[[nodiscard]] std::vector<std::string> noise_remarks(const IdentificationProblem& problem);

}  // namespace host_sim::identification
