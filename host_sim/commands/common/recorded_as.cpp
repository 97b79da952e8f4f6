#include "host_sim/commands/common/recorded_as.hpp"

#include "host_sim/identification/predict/recording_faults.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace host_sim {

RecordedAs recorded_as(const firmware::RigDescription& description) {
  RecordedAs as;
  as.moved = [description](const firmware::Recording& recorded, const firmware::Recording& simulated,
                           SimulationInput& input) {
    identification::smooth_input(description, recorded, simulated, input);
  };
  if (!description.recorder.any()) return as;
  const firmware::RecorderDescription& recorder = description.recorder;
  as.varied = [recorder](const auto& rig, std::size_t samples, double period) {
    return identification::variation_of(rig, identification::described_faults(recorder, {}, {}), samples, period);
  };
  as.recorded = [recorder](const firmware::Recording& measured, model::Channel input, Response& channels) {
    identification::record_with(recorder, input, measured, channels);
  };
  return as;
}

}  // namespace host_sim
