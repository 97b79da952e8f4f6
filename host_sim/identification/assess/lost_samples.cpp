#include "host_sim/identification/assess/lost_samples.hpp"

#include <cstddef>

#include "host_sim/identification/assess/thresholds.hpp"

namespace host_sim::identification {

std::vector<RecordingFault> lost_samples(const IdentificationProblem& problem) {
  constexpr double confidence = thresholds::highest_confidence;
  const auto counted = [](double value) { return Interval{value, value, value}; };
  std::vector<RecordingFault> faults;
  std::size_t lost = 0;
  for (const PreparedRecording& r : problem.samples()) {
    lost += r.recording.lost_rows;
    for (const firmware::Recording::Gap& gap : r.recording.gaps) {
      faults.push_back({"gap", {}, {{"from_s", counted(gap.from)}, {"to_s", counted(gap.to)}}, confidence});
    }
  }
  if (lost > 0) faults.push_back({"lost_rows", {}, {{"count", counted(static_cast<double>(lost))}}, confidence});
  return faults;
}

}  // namespace host_sim::identification
