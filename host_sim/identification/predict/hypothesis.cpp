#include "host_sim/identification/predict/hypothesis.hpp"

#include "host_sim/comparison/start_state.hpp"

namespace host_sim::identification {

Hypothesis described_hypothesis(const firmware::RigDescription& description,
                                const std::vector<PreparedRecording>& recordings) {
  Hypothesis given{explained_part(description.rig), {}};
  for (const PreparedRecording& r : recordings) {
    given.starts.push_back(r.at_rest ? resting(given.rig, r.input)
                                     : estimated_start(given.rig, r.input, r.recording, r.range));
  }
  return given;
}

void estimate_held_out_starts(Hypothesis& hypothesis, const std::vector<PreparedRecording>& recordings) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const PreparedRecording& r = recordings[i];
    if (r.fitted.size() > 0 || r.at_rest) continue;
    hypothesis.starts[i] = estimated_start(hypothesis.rig, r.input, r.recording, r.range);
  }
}

}  // namespace host_sim::identification
