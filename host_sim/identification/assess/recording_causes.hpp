// Faults of the recordings that a selected model holds, as they are reported.
#pragma once

#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"

namespace host_sim::identification {

/// The faults of `found.best`, under the names of contract.md: a clock as clock_offset [s] and clock_drift [ppm], those
/// of its values that are fitted. Where a clock is off in more than half of the channels, the input's included, it is
/// the others', with the input among them, that are off by the opposite: the smaller group is named. Then the
/// events of `found`. `parameters`: intervals() of its fit.
[[nodiscard]] std::vector<RecordingFault> recording_causes(const IdentificationProblem& problem,
                                                           const SearchResult& found,
                                                           const SelectionCriterion& criterion,
                                                           const std::vector<Interval>& parameters,
                                                           const Certainty& certainty);

}  // namespace host_sim::identification
