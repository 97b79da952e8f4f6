#include "host_sim/identification/prepare/sampled_recording.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/comparison/model_rate.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

using Flags = std::vector<bool>;

/// Samples that were not recorded or lie outside the measuring range; empty: none.
Flags clipped_samples(const firmware::RigDescription& description, const firmware::Recording& recording,
                      model::Channel channel) {
  const auto& data = recording[channel];
  const auto& range = description.range[index(channel)];
  if (!range && recording.filled.empty()) return {};
  Flags clipped = recording.filled;
  clipped.resize(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) clipped[k] = clipped[k] || (range && !range->holds(data[k]));
  if (std::find(clipped.begin(), clipped.end(), true) == clipped.end()) clipped.clear();
  return clipped;
}

/// Every n-th sample; no channel is filtered.
firmware::Recording picked(const firmware::Recording& recording, std::size_t n) {
  firmware::Recording fewer = recording.without_samples();
  fewer.sample_period = recording.sample_period * static_cast<double>(n);
  const auto pick = [n](const auto& values, auto& result) {
    for (std::size_t k = 0; k < values.size(); k += n) result.push_back(values[k]);
  };
  pick(recording.time, fewer.time);
  pick(recording.filled, fewer.filled);
  for (std::size_t c = 0; c < fewer.channels.size(); ++c) pick(recording.channels[c], fewer.channels[c]);
  for (std::size_t j = 0; j < fewer.ducts.size(); ++j) pick(recording.ducts[j], fewer.ducts[j]);
  return fewer;
}

/// Samples of which one is kept.
std::size_t samples_per_kept(double period) {
  constexpr double rounding = 1e-6;
  return std::max<std::size_t>(1, static_cast<std::size_t>(thresholds::shortest_period / period + rounding));
}

/// Channels that the real-time program computes carry no sensor's noise.
bool is_computed(model::RigKind kind, model::Channel channel) {
  if (kind == model::RigKind::quarter_car) return false;
  return channel != model::Channel::x_act && channel != model::Channel::F;
}

/// The noise of everything that is measured: each channel by itself, then those whose colour is not clear once more
/// with that of the others.
void find_noise(SampledRecording& result, const firmware::RigDescription& description,
                const firmware::Recording& recording) {
  for (const bool again : {false, true}) {
    if (again && !result.expected_colour) break;
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      const model::Channel channel = model::channel_at(c);
      if (!recording.has(channel)) continue;
      const ChannelNoise& before = result.channel_noise[c];
      if (again && before.is_known() && before.colour.is_white()) continue;
      const SensorNoise found = find_sensor_noise(description, recording, channel, result.expected_colour);
      result.channel_noise[c] = found.noise;
      result.noise_factor[c] = found.factor;
      result.noise[c] = found.noise.level;
    }
    ChannelNoises measured = result.channel_noise;
    for (std::size_t c = 0; c < measured.size(); ++c) {
      if (is_computed(description.rig.kind, model::channel_at(c))) measured[c] = {};
    }
    result.expected_colour = expected_colour(measured);
  }
}

void interpolate(SampledRecording& sampled) {
  sampled.step = model_steps_per_sample(sampled.recording.sample_period);
  if (sampled.step == 1) return;
  sampled.recording = interpolated(sampled.recording, sampled.step);
  const auto step = static_cast<double>(sampled.step);
  for (std::size_t c = 0; c < sampled.clipped.size(); ++c) {
    Flags& clipped = sampled.clipped[c];
    if (!clipped.empty()) {
      Flags finer(sampled.recording.size());
      for (std::size_t k = 0; k < finer.size(); ++k) {
        finer[k] = clipped[k / sampled.step] || clipped[(k + sampled.step - 1) / sampled.step];
      }
      clipped = std::move(finer);
    }
    auto& renewals = sampled.renewals[c];
    if (!renewals) continue;
    for (std::size_t& k : renewals->at) k *= sampled.step;
    for (double* const time : {&renewals->period, &renewals->period_slack, &renewals->first, &renewals->slack}) {
      *time *= step;
    }
  }
}

}  // namespace

double SampledRecording::noise_at_every_sample(model::Channel channel) const {
  return noise[index(channel)] * std::sqrt(static_cast<double>(step));
}

SampledRecording sampled(const firmware::RigDescription& description, firmware::Recording recording) {
  const std::size_t fewer = samples_per_kept(recording.sample_period);
  if (fewer > 1) recording = picked(recording, fewer);
  SampledRecording result;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel channel = model::channel_at(c);
    if (!recording.has(channel)) continue;
    result.clipped[c] = clipped_samples(description, recording, channel);
    result.renewals[c] = renewals_of(recording[channel]);
  }
  find_noise(result, description, recording);
  result.recording = std::move(recording);
  interpolate(result);
  return result;
}

firmware::Recording at_simulated_rate(firmware::Recording recording) {
  const std::size_t fewer = samples_per_kept(recording.sample_period);
  if (fewer > 1) return picked(recording, fewer);
  return interpolated(recording, model_steps_per_sample(recording.sample_period));
}

}  // namespace host_sim::identification
