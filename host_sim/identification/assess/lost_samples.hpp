// Gaps, NaN and lost rows, reported as faults of the recording.
#pragma once

#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// `gap` with from_s and to_s for each of more than 20 ms, and `lost_rows` with the count of rows that are missing or
/// incomplete, those in gaps included, over all recordings. Counted, not estimated: intervals have no width.
[[nodiscard]] std::vector<RecordingFault> lost_samples(const IdentificationProblem& problem);

}  // namespace host_sim::identification
