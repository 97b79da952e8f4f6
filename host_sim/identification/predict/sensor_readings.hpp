// What a hypothesis predicts for a recording: true channels by simulation, then the readings of their sensors.
#pragma once

#include <vector>

#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/identification/predict/hypothesis.hpp"

namespace host_sim::identification {

/// Model steps per sample of a rig that is stepped finely (comparison/fine_steps.hpp). The difference of two simulations may take half of them: what a step
/// gets wrong is nearly the same in both.
struct Resolution {
  int substeps = 1;
  bool half = false;
  bool doubled = false;  ///< twice the steps of any rig: what the steps get wrong (estimate/uncertainty_sources.hpp)
};

/// Channels before their sensors: the rig's own motion and forces at the recording's sample rate. `input`: that of the
/// recording, or one that differs from it by noise; effects of its own sensor are undone first (true_input.hpp).
/// `samples`: how many, 0 for all. A channel without a simulation of
/// its own (z̈_r) is taken from the input. A parameter that drifts changes in small steps. Of what is no rig (a
/// parameter that is not a number, or drifts below its bound) no channel is a number, so that its χ² is infinite.
[[nodiscard]] Response true_channels(const Hypothesis& hypothesis, const PreparedRecording& recording,
                                     const SimulationInput& input, const InitialState& start, std::size_t samples,
                                     Resolution resolution);

/// A hypothesis with the state and the input that a simulation of a recording begins with.
struct SimulatedRig {
  const Hypothesis* hypothesis;
  const InitialState* start;
  const SimulationInput* input;
};
/// true_channels() of several rigs, side by side where the processor can (comparison/side_by_side.hpp); of each the
/// channels that the recording explains. Bit for bit the same.
[[nodiscard]] std::vector<Response> true_channels_of_each(const std::vector<SimulatedRig>& rigs,
                                                          const PreparedRecording& recording, std::size_t samples,
                                                          Resolution resolution);

/// Whether a sensor effect acts between a channel and its readings.
[[nodiscard]] bool has_sensor_effect(const model::RigParameters<double>& rig, model::Channel channel);

/// True if a channel's samples differ from its true values by a sensor effect or a fault of the recording.
[[nodiscard]] bool is_altered(const Hypothesis& hypothesis, model::Channel channel);

/// Readings of one channel from its true values: the model's own sensors (model/components/sensors.hpp) are stepped over one
/// channel, so a sensor effect costs no simulation. A held channel is renewed where the recording was
/// (prepare/sample_hold.hpp), with the value of that sample or, by a clock of its own,
///
///   (1)  reading(t) = truth(t_0 + n P),   t_0 = first + phase · slack,   truth between samples on a cubic
///
/// Behind the sensors act the faults of the recording (recording_faults.hpp).
[[nodiscard]] std::vector<double> sensor_readings(const Hypothesis& hypothesis, const PreparedRecording& recording,
                                                  model::Channel channel, const std::vector<double>& truth);
/// The signal of which a held channel takes its values; of another one its readings without faults of the recording.
[[nodiscard]] std::vector<double> readings_before_hold(const Hypothesis& hypothesis, const PreparedRecording& recording,
                                                       model::Channel channel, const std::vector<double>& truth);

/// true_channels(), then sensor_readings() of each explained channel.
[[nodiscard]] Response read_channels(const Hypothesis& hypothesis, const PreparedRecording& recording,
                                     const SimulationInput& input, const InitialState& start, std::size_t samples,
                                     Resolution resolution);

}  // namespace host_sim::identification
