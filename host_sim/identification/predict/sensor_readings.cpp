#include "host_sim/identification/predict/sensor_readings.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "host_sim/comparison/side_by_side.hpp"
#include "host_sim/identification/predict/true_input.hpp"
#include "model/components/sensors.hpp"

namespace host_sim::identification {

using model::Channel;
using Rig = model::RigParameters<double>;

namespace {

Rig without_sensors(const Rig& rig) {
  Rig bare = rig;
  bare.effects.for_each_sensor([](auto& slot, Channel) { slot = {}; });
  return bare;
}

/// A rig with another machine.
Rig moved_by(Rig rig, const std::vector<firmware::PlacedEffect>& machine) {
  for (const firmware::PlacedEffect& effect : firmware::effects_of(rig)) {
    if (effect.entry->subsystem == model::Subsystem::machine) firmware::remove_effect(rig, *effect.entry, std::nullopt);
  }
  for (const firmware::PlacedEffect& effect : machine) firmware::put_effect(rig, effect);
  return rig;
}

/// Model steps per sample.
int steps_of(const Rig& bare, double period, Resolution resolution) {
  const int steps =
      host_sim::steps_of(bare, period, resolution.half ? (resolution.substeps + 1) / 2 : resolution.substeps);
  return resolution.doubled && !firmware::find_rig_fault(bare, period / (2 * steps)) ? 2 * steps : steps;
}

/// z̈_r is no channel of a simulation: its input holds it.
void add_acceleration(const PreparedRecording& recording, const SimulationInput& input, std::size_t samples,
                      Response& response) {
  if (!recording.explains(Channel::zdd_r) || input.channel == Channel::z_cmd) return;
  auto& acceleration = response[index(Channel::zdd_r)];
  const std::size_t count = samples == 0 ? input.size() : std::min(samples, input.size());
  acceleration.resize(count);
  for (std::size_t k = 0; k < count; ++k) acceleration[k] = input.motion[k].acceleration;
}

/// The channels to be simulated: those that a rig answers with, and where the wheel is prescribed also its
/// acceleration.
std::vector<Channel> simulated_channels(const Rig& rig, const SimulationInput& input) {
  std::vector<Channel> channels = response_channels(rig.kind, input);
  if (input.wheel_prescribed) channels.push_back(Channel::zdd_w);
  return channels;
}

/// F_w on a prescribed wheel: what the stiff tyre of the simulation carries, less what it takes to move the simulated
/// wheel, leaves the forces on the wheel, and m_w z̈_w of the measured one is added. Without that F_w would hold how the
/// tyre catches up with a wheel that moves as a cubic between samples, or that a knock has hit.
void correct_wheel_load(const Rig& rig, const SimulationInput& input, Response& response) {
  if (!input.wheel_prescribed) return;
  std::vector<double>& simulated = response[index(Channel::zdd_w)];
  auto& load = response[index(Channel::F_w)];
  for (std::size_t k = 0; k < load.size(); ++k) {
    load[k] += rig.wheel.mass * (input.motion[k].acceleration - simulated[k]);
  }
  simulated.clear();
}

/// What a simulation leaves to be done.
void complete(const Rig& rig, const PreparedRecording& recording, const SimulationInput& input, std::size_t samples,
              Response& response) {
  add_acceleration(recording, input, samples, response);
  correct_wheel_load(rig, input, response);
}

/// Whether the model can step it; with a parameter that drifts, at both ends of the recording.
bool is_no_rig(const Rig& bare, const std::vector<PlacedFault>& faults, double period) {
  const auto fails = [&](const Rig& rig) { return firmware::find_rig_fault(rig, period).has_value(); };
  if (!drifts(faults)) return fails(bare);
  return fails(drifted(bare, faults, 0.0)) || fails(drifted(bare, faults, 0.5)) || fails(drifted(bare, faults, 1.0));
}

/// What no rig answers: its χ² is infinite.
Response no_answer(const PreparedRecording& recording, const SimulationInput& input, std::size_t samples) {
  Response response;
  const std::size_t count = samples == 0 ? input.size() : std::min(samples, input.size());
  for (const Channel channel : recording.channels) response[index(channel)].assign(count, std::nan(""));
  return response;
}

/// Counts a simulation. What comes around a step (input, sensors, spectrum) costs as much as four steps a sample, new
/// matrices for a parameter that drifts as much as sixty: both measured on a component bench.
void count_work(const PreparedRecording& recording, const RigVariation& variation, std::size_t samples, int steps) {
  constexpr double around = 4.0, new_matrices = 60.0;
  const auto count = static_cast<double>(samples == 0 ? recording.size() : std::min(samples, recording.size()));
  double cost = count * (static_cast<double>(steps) + around);
  if (variation.every > 0) cost += new_matrices * count / static_cast<double>(variation.every);
  recording.work->add_simulation(recording.machine ? 2.0 * cost : cost);
}

/// The same rig with another machine.
RigVariation moved_by(const RigVariation& variation, const std::vector<firmware::PlacedEffect>& machine) {
  if (variation.every == 0) return {};
  return {variation.every, [=](std::size_t k) { return moved_by(variation.at(k), machine); }};
}

}  // namespace

Response true_channels(const Hypothesis& hypothesis, const PreparedRecording& recording, const SimulationInput& read,
                       const InitialState& begin, std::size_t samples, Resolution resolution) {
  const std::optional<TrueInput> before = true_input(hypothesis, recording, read, begin);
  const SimulationInput& input = before ? before->input : read;
  const InitialState& start = before ? before->start : begin;
  const Rig bare = without_sensors(hypothesis.rig);
  const std::vector<PlacedFault> faults = hypothesis.all_faults();
  if (is_no_rig(bare, faults, input.period)) return no_answer(recording, input, samples);
  const RigVariation variation = variation_of(bare, faults, recording.size(), input.period);
  const int steps = steps_of(bare, input.period, resolution);
  count_work(recording, variation, samples, steps);
  Response response = simulate(bare, input, start, samples, steps, simulated_channels(bare, input), variation);
  if (recording.machine) {
    const Rig rig = moved_by(bare, *recording.machine);
    const RigVariation moved = moved_by(variation, *recording.machine);
    response[index(Channel::F)] =
        std::move(simulate(rig, input, start, samples, steps, {Channel::F}, moved)[index(Channel::F)]);
  }
  complete(bare, recording, input, samples, response);
  return response;
}

std::vector<Response> true_channels_of_each(const std::vector<SimulatedRig>& rigs, const PreparedRecording& recording,
                                            std::size_t samples, Resolution resolution) {
  std::vector<Response> responses(rigs.size());
  if (rigs.empty()) return responses;
  std::vector<std::optional<TrueInput>> before(rigs.size());
  std::vector<SimulatedRig> driven = rigs;
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    before[i] = true_input(*rigs[i].hypothesis, recording, *rigs[i].input, *rigs[i].start);
    if (before[i]) driven[i] = {rigs[i].hypothesis, &before[i]->start, &before[i]->input};
  }
  std::vector<Channel> channels = simulated_channels(rigs.front().hypothesis->rig, *rigs.front().input);
  std::erase_if(channels, [&](Channel channel) { return !recording.explains(channel) && channel != Channel::zdd_w; });
  std::vector<Rig> bare;
  std::vector<RigVariation> variations;
  std::vector<int> steps;  // 0: no rig
  for (const SimulatedRig& one : rigs) {
    const std::vector<PlacedFault> faults = one.hypothesis->all_faults();
    bare.push_back(without_sensors(one.hypothesis->rig));
    variations.push_back(variation_of(bare.back(), faults, recording.size(), one.input->period));
    const bool none = is_no_rig(bare.back(), faults, one.input->period);
    if (none) responses[steps.size()] = no_answer(recording, *one.input, samples);
    steps.push_back(none ? 0 : steps_of(bare.back(), one.input->period, resolution));
  }
  std::set<int> counts(steps.begin(), steps.end());
  counts.erase(0);
  for (const int count : counts) {
    std::vector<std::size_t> chosen;
    std::vector<SideBySideRig> group;
    for (std::size_t i = 0; i < rigs.size(); ++i) {
      if (steps[i] != count) continue;
      chosen.push_back(i);
      group.push_back({&bare[i], driven[i].start, driven[i].input, &variations[i]});
      count_work(recording, variations[i], samples, count);
    }
    auto simulated = simulate_side_by_side(group, samples, count, channels);
    if (recording.machine) {
      std::vector<Rig> moved;
      std::vector<RigVariation> moved_variations;
      for (const std::size_t i : chosen) {
        moved.push_back(moved_by(bare[i], *recording.machine));
        moved_variations.push_back(moved_by(variations[i], *recording.machine));
      }
      for (std::size_t i = 0; i < moved.size(); ++i) {
        group[i].rig = &moved[i];
        group[i].variation = &moved_variations[i];
      }
      auto forces = simulate_side_by_side(group, samples, count, {Channel::F});
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        simulated[i][index(Channel::F)] = std::move(forces[i][index(Channel::F)]);
      }
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) responses[chosen[i]] = std::move(simulated[i]);
  }
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    if (steps[i] > 0) complete(bare[i], recording, *driven[i].input, samples, responses[i]);
  }
  return responses;
}

bool is_altered(const Hypothesis& hypothesis, Channel channel) {
  return has_sensor_effect(hypothesis.rig, channel) || alters(hypothesis.faults, channel) ||
         alters(hypothesis.recorder, channel);
}

bool has_sensor_effect(const Rig& rig, Channel channel) {
  bool any = false;
  rig.effects.for_each_sensor([&](const auto& slot, Channel of) { any = any || (of == channel && slot.active); });
  return any;
}

namespace {

/// The value at `place` [samples], on the cubic through the four samples around it.
double at(const std::vector<double>& values, double place) {
  const double last = static_cast<double>(values.size() - 1);
  place = std::clamp(place, 0.0, last);
  const auto i =
      std::clamp<std::size_t>(static_cast<std::size_t>(place), 1, std::max<std::size_t>(values.size(), 4) - 3);
  if (values.size() < 4) return values[static_cast<std::size_t>(place)];
  const double r = place - static_cast<double>(i);
  if (r == 0.0) return values[i];
  const double a = r + 1.0, c = r - 1.0, d = r - 2.0;
  return -r * c * d / 6.0 * values[i - 1] + a * c * d / 2.0 * values[i] - a * r * d / 2.0 * values[i + 1] +
         a * r * c / 6.0 * values[i + 2];
}

/// What a held channel shows of `values`.
std::vector<double> held_values(const std::vector<double>& values, const Renewals& renewals, const HoldClock& clock) {
  std::vector<double> shown(values.size());
  double now = values.front();
  std::size_t n = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (n < renewals.at.size() && renewals.at[n] == k) {
      now = at(values, taken_at(renewals, n, clock));
      ++n;
    }
    shown[k] = now;
  }
  return shown;
}

bool is_held(const Rig& rig, const PreparedRecording& recording, Channel channel) {
  return rig.effects.sensor_paths()[index(channel)].hold > 0.0 && recording.renewals[index(channel)];
}

/// A channel as its sensors give it, but for a hold that is renewed where the recording was.
std::vector<double> through_all_but_hold(const Rig& rig, const PreparedRecording& recording, Channel channel,
                                         const std::vector<double>& truth) {
  if (!has_sensor_effect(rig, channel) || truth.empty()) return truth;
  const auto c = index(channel);
  std::array<model::SensorPath<double>, model::channel_count> paths{};
  paths[c] = rig.effects.sensor_paths()[c];
  if (is_held(rig, recording, channel)) paths[c].hold = 0.0;
  std::vector<double> values = truth;
  const model::Sensors<double> sensors(paths, recording.input.period);
  if (sensors.any()) {
    model::Sensors<double>::State state;
    model::Signals<double> signals{};
    for (std::size_t k = 0; k < truth.size(); ++k) {
      signals[c] = truth[k];
      if (k == 0) {
        sensors.start(state, signals, nullptr);
      } else {
        sensors.step(state, signals, nullptr);
      }
      values[k] = sensors.reading(state, channel, truth[k]);
    }
  }
  return values;
}

}  // namespace

std::vector<double> readings_before_hold(const Hypothesis& hypothesis, const PreparedRecording& recording,
                                         Channel channel, const std::vector<double>& truth) {
  return through_all_but_hold(hypothesis.rig, recording, channel,
                              before_filter_of_input(hypothesis.all_faults(), channel, truth, recording.input.period));
}

std::vector<double> sensor_readings(const Hypothesis& hypothesis, const PreparedRecording& recording, Channel channel,
                                    const std::vector<double>& truth) {
  std::vector<double> values = readings_before_hold(hypothesis, recording, channel, truth);
  const auto c = index(channel);
  if (!values.empty() && is_held(hypothesis.rig, recording, channel)) {
    values = held_values(values, *recording.renewals[c], hypothesis.clocks[c]);
  }
  return with_faults(hypothesis.all_faults(), channel, std::move(values), recording.input.period);
}

Response read_channels(const Hypothesis& hypothesis, const PreparedRecording& recording, const SimulationInput& input,
                       const InitialState& start, std::size_t samples, Resolution resolution) {
  Response response = true_channels(hypothesis, recording, input, start, samples, resolution);
  for (const Channel channel : recording.channels) {
    if (is_altered(hypothesis, channel)) {
      response[index(channel)] = sensor_readings(hypothesis, recording, channel, response[index(channel)]);
    }
  }
  return response;
}

}  // namespace host_sim::identification
