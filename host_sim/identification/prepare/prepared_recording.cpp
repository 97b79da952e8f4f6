#include "host_sim/identification/prepare/prepared_recording.hpp"

#include <cmath>

#include "firmware/description/input_error.hpp"
#include "host_sim/comparison/start_state.hpp"
#include "host_sim/identification/prepare/input_fusion.hpp"
#include "host_sim/identification/prepare/sensor_noise.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;
using model::RigKind;

namespace {

/// The two sensors of the foot point; nullopt where they are not both recorded, or one is without noise.
struct FootSensors {
  ChannelNoise position_noise, acceleration_noise;
  std::vector<double> acceleration;  ///< not a number where clipped
};
std::optional<FootSensors> foot_sensors(const firmware::RigDescription& description,
                                        const firmware::Recording& recording) {
  if (description.rig.kind != RigKind::quarter_car) return std::nullopt;
  if (!recording.has(Channel::z_r) || !recording.has(Channel::zdd_r)) return std::nullopt;
  FootSensors sensors{find_sensor_noise(description, recording, Channel::z_r).noise,
                      find_sensor_noise(description, recording, Channel::zdd_r).noise, recording[Channel::zdd_r]};
  if (!(sensors.position_noise.level > 0.0) || !(sensors.acceleration_noise.level > 0.0)) return std::nullopt;
  if (const auto& range = description.range[index(Channel::zdd_r)]) {
    for (double& a : sensors.acceleration) a = range->holds(a) ? a : std::nan("");
  }
  return sensors;
}

void prepare_input(PreparedRecording& prepared, const firmware::RigDescription& description,
                   const firmware::Recording& recording, bool disagree) {
  const Channel input = prepared.input.channel;
  if (input == Channel::x_cmd) return;  // computed, without noise
  const ChannelNoise noise = find_sensor_noise(description, recording, input).noise;
  const double position_noise = noise.level;
  prepared.input_noise.position = position_noise;
  prepared.input_noise.position_colour = noise.colour;
  const auto sensors = foot_sensors(description, recording);
  if (!sensors) return;
  const double h = recording.sample_period;
  prepared.inputs_disagree = disagree;
  if (disagree) {
    prepared.input.motion = firmware::through_samples(recording[Channel::z_r], 1.0 / h);
    prepared.acceleration_known = known_up_to(recording[Channel::z_r], position_noise, h);
    smooth_acceleration(prepared.input.motion, thresholds::acceleration_edge * prepared.acceleration_known, h);
    return;
  }
  prepared.input.motion = firmware::through_samples(fused_displacement(recording[Channel::z_r], sensors->acceleration,
                                                                       position_noise, sensors->acceleration_noise.level, h),
                                                    1.0 / h);
  prepared.input_noise.acceleration = sensors->acceleration_noise.level;
  prepared.input_noise.acceleration_colour = sensors->acceleration_noise.colour;
}

/// Samples that were not recorded or lie outside the measuring range; empty: none.
std::vector<bool> clipped_samples(const firmware::RigDescription& description, const firmware::Recording& recording,
                                  Channel channel) {
  const auto& data = recording[channel];
  const auto& range = description.range[index(channel)];
  if (!range && recording.filled.empty()) return {};
  std::vector<bool> clipped = recording.filled;
  clipped.resize(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) clipped[k] = clipped[k] || (range && !range->holds(data[k]));
  if (std::find(clipped.begin(), clipped.end(), true) == clipped.end()) clipped.clear();
  return clipped;
}

/// The noise of everything that is measured: each channel by itself, then those whose colour is not clear once more with
/// that of the others.
void find_noise(PreparedRecording& prepared, const firmware::RigDescription& description,
                const firmware::Recording& recording) {
  std::vector<Channel> sensors = prepared.channels;
  if (description.rig.kind == RigKind::quarter_car) sensors.insert(sensors.end(), {Channel::z_r, Channel::zdd_r});
  for (const bool again : {false, true}) {
    if (again && !prepared.expected_colour) break;
    for (const Channel channel : sensors) {
      const auto c = index(channel);
      if (!recording.has(channel)) continue;
      if (again && prepared.channel_noise[c].is_known() && prepared.channel_noise[c].colour.is_white()) continue;
      const SensorNoise found = find_sensor_noise(description, recording, channel, prepared.expected_colour);
      prepared.declared_noise[c] = description.noise[c];
      prepared.channel_noise[c] = found.noise;
      prepared.noise_factor[c] = found.factor;
      if (prepared.explains(channel)) prepared.noise[c] = found.noise.level;
    }
    prepared.expected_colour = expected_colour(prepared.channel_noise);
  }
}

void split(PreparedRecording& prepared, Use use, std::size_t samples) {
  std::size_t end = samples;
  if (use == Use::shared) end -= samples / thresholds::held_out_part;
  if (use == Use::held_out) end = 0;
  prepared.fitted = {0, end};
  prepared.held_out = {end, samples};
}

}  // namespace

Window PreparedRecording::comparable(Channel channel, Window window) const {
  if (channel != Channel::zdd_r || !(acceleration_known > 0.0)) return window;
  const auto margin = static_cast<std::size_t>(thresholds::acceleration_reach / input.period);
  window.from = std::max(window.from, margin);
  window.to = std::max(window.from, std::min(window.to, size() - std::min(size(), margin)));
  return window;
}

model::RigParameters<double> explained_part(const model::RigParameters<double>& rig) {
  if (rig.kind != RigKind::hil) return rig;
  model::RigParameters<double> part = rig;
  part.kind = RigKind::component_bench;
  part.machine.virtual_damping = 0.0;
  return part;
}

std::optional<HoldPeriod> hold_period(const std::vector<PreparedRecording>& recordings, Channel channel) {
  double sum = 0.0, weights = 0.0, slack = INFINITY;
  for (const PreparedRecording& r : recordings) {
    const auto& renewals = r.renewals[index(channel)];
    if (!renewals) continue;
    const double weight = renewals->turn.back();
    sum += weight * renewals->period * r.input.period;
    weights += weight;
    slack = std::min(slack, renewals->period_slack * r.input.period);
  }
  if (!(weights > 0.0)) return std::nullopt;
  return HoldPeriod{sum / weights, slack};
}

bool inputs_disagree(const firmware::RigDescription& description, const firmware::Recording& recording) {
  const auto sensors = foot_sensors(description, recording);
  return sensors && disagree(recording[Channel::z_r], sensors->acceleration, sensors->position_noise.level,
                             sensors->acceleration_noise.level, recording.sample_period);
}

PreparedRecording prepare_recording(const firmware::RigDescription& description, firmware::Recording recording, Use use,
                                    bool disagree) {
  const double duration = recording.sample_period * static_cast<double>(recording.size());
  if (duration < thresholds::shortest_recording) {
    throw firmware::InputError(recording.source, 0, "the recording lasts " + std::to_string(duration) + " s",
                               "at least 5 s");
  }
  const model::RigParameters<double> rig = explained_part(description.rig);
  PreparedRecording prepared;
  prepared.input = simulation_input(rig, recording);
  prepared.substeps = std::max(1, static_cast<int>(std::lround(prepared.input.period / thresholds::step_with_corners)));
  prepare_input(prepared, description, recording, disagree);
  prepared.at_rest = begins_at_rest(rig, prepared.input, recording);
  std::vector<Channel> simulated = response_channels(rig.kind, prepared.input);
  if (prepared.inputs_disagree) simulated.push_back(Channel::zdd_r);
  for (const Channel channel : simulated) {
    if (!recording.has(channel)) continue;
    const auto c = index(channel);
    prepared.channels.push_back(channel);
    prepared.renewals[c] = renewals_of(recording[channel]);
    prepared.clipped[c] = clipped_samples(description, recording, channel);
  }
  find_noise(prepared, description, recording);
  if (prepared.channels.empty()) {
    throw firmware::InputError(recording.source, 0, "nothing is measured that the model could explain",
                               "one channel at least beside the input");
  }
  split(prepared, use, recording.size());
  prepared.recording = std::move(recording);
  return prepared;
}

}  // namespace host_sim::identification
