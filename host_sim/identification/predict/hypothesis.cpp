#include "host_sim/identification/predict/hypothesis.hpp"

#include <utility>

#include "host_sim/comparison/start_state.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"

namespace host_sim::identification {

Hypothesis described_hypothesis(const firmware::RigDescription& description,
                                const std::vector<PreparedRecording>& recordings) {
  Hypothesis given{explained_part(description.rig), {}};
  for (const PreparedRecording& r : recordings) {
    given.starts.push_back(r.at_rest ? resting(given.rig, r.input)
                                     : estimated_start(given.rig, r.input, r.recording, r.range));
  }
  if (!description.recorder.any() || recordings.empty()) return given;
  const PreparedRecording& first = recordings.front();
  std::vector<PlacedFault> recorder = described_faults(description.recorder, first.input.channel, first.channels);
  const auto is_hum = [](const PlacedFault& fault) { return fault.kind == FaultKind::mains_hum; };
  for (const PlacedFault& fault : recorder) {
    if (!is_hum(fault)) given.recorder.push_back(fault);
  }
  if (recordings.size() > 1) return given;
  const Response read = read_channels(given, first, first.input, given.starts.front(), 0, {first.substeps});
  for (PlacedFault& fault : recorder) {
    if (!is_hum(fault)) continue;
    set_phases(fault, first.recording, read);
    given.recorder.push_back(std::move(fault));
  }
  return given;
}

std::vector<PlacedFault> Hypothesis::all_faults() const {
  std::vector<PlacedFault> all = recorder;
  all.insert(all.end(), faults.begin(), faults.end());
  return all;
}

void estimate_held_out_starts(Hypothesis& hypothesis, const std::vector<PreparedRecording>& recordings) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const PreparedRecording& r = recordings[i];
    if (r.fitted.size() > 0 || r.at_rest) continue;
    hypothesis.starts[i] = estimated_start(hypothesis.rig, r.input, r.recording, r.range);
  }
}

}  // namespace host_sim::identification
