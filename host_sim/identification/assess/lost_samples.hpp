// Gaps, NaN and lost rows, reported as faults of the recording.
#pragma once

#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// `gap` with from_s and to_s for each of more than 20 ms, and `lost_rows` with the count of rows that are missing or
/// incomplete, those in gaps included, over all recordings. Then by channel `outliers` with their count, which are left
/// out, and `quantisation` with the step of rounding that makes its noise louder (prepare/sample_faults.hpp). An
/// outlier counts where the model that was found, `found`, does not read what was recorded there: a rig may touch a
/// stop for the time of a sample. Outliers are a cause, and rounding is one where noise was declared without it; else
/// noise is merely not known. Counted, not estimated: intervals have no width.
[[nodiscard]] std::vector<RecordingFault> lost_samples(const IdentificationProblem& problem, const Hypothesis& found);

}  // namespace host_sim::identification
