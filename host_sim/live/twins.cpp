#include "host_sim/live/twins.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/description/rig_description.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/identification/estimate/free_parameter.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/live/thresholds.hpp"

namespace host_sim::live {

using model::Channel;
using Rig = model::RigParameters<double>;

namespace {

Rig without_sensors(const Rig& rig) {
  Rig bare = rig;
  bare.effects.for_each_sensor([](auto& slot, Channel) { slot = {}; });
  return bare;
}

/// The sensor of one channel of a rig.
model::Sensors<double> sensor_of(const Rig& rig, Channel channel, double period) {
  std::array<model::SensorPath<double>, model::channel_count> paths{};
  paths[index(channel)] = rig.effects.sensor_paths()[index(channel)];
  return {paths, period};
}

/// What wears while a rig runs. Masses, areas and ducts stay what they are.
bool may_change(const firmware::ParameterPath& path) { return path.table == "suspension" || path.table == "tyre"; }

std::string unit_of(const model::EffectParameter& card, std::optional<Channel> channel) {
  return std::string(channel && card.unit.starts_with("of ") ? model::unit(*channel) : card.unit);
}

}  // namespace

Twins::Twins(const firmware::RigDescription& description, const identification::PreparedRecording& known)
    : rig_(identification::explained_part(description.rig)),
      bare_(without_sensors(rig_)),
      like_(simulation_input(rig_, known.recording)) {
  // A diagnosis of recordings fuses z_r with z̈_r; here z_r drives alone, and its sensor may fail.
  std::vector<identification::PreparedRecording> recordings{known};
  recordings.front().inputs_fused = false;
  input_sensor_ = recordings.front().input_sensor();
  const std::vector<Channel> simulated = response_channels(rig_.kind, like_);
  for (const Channel channel : known.channels) {
    if (std::find(simulated.begin(), simulated.end(), channel) == simulated.end()) continue;
    channels_.push_back(channel);
  }
  describe_sensors();
  const identification::Hypothesis hypothesis = identification::described_hypothesis(description, recordings);
  const Response response = simulate(bare_, like_, hypothesis.starts.front());
  const identification::Scales scales = identification::scales_of(recordings, hypothesis, {response});
  for (const identification::Candidate& found : identification::candidates(recordings, hypothesis, scales)) {
    add(found);
  }
  // What the rig has already may become larger or smaller, in the steps of its card.
  for (const firmware::PlacedEffect& present : firmware::effects_of(rig_)) {
    const auto& entry = *present.entry;
    const bool reading = entry.parameters.empty() || entry.parameters[0].starts.read != model::Reading::nothing;
    if (entry.parameters.size() != 1 || reading || present.values[0] == entry.parameters[0].neutral) continue;
    const auto& card = entry.parameters[0];
    model::MotionScales motion = scales.motion;
    if (present.channel) motion.channel = scales.rms[index(*present.channel)];
    std::vector<double> values;
    for (const double factor : card.starts.factors) {
      for (const double sign : {1.0, -1.0}) {
        const double value = present.values[0] + sign * (factor * card.starts.scale(motion) - card.neutral);
        if (value > card.lower && value < card.upper) values.push_back(value);
      }
      if (identification::is_proportional(card)) break;
    }
    add_cause({&entry, present.channel, firmware::effect_path(present, 0), unit_of(card, present.channel),
               present.values[0], card.lower, card.upper},
              values, bare_);
  }
  // A parameter by a twentieth, which is linear and far above rounding.
  constexpr double part = 0.05;
  for (const firmware::ParameterPath& path : firmware::parameter_paths()) {
    Rig changed = bare_;
    if (!may_change(path) || !firmware::has_part(rig_, path.table) || path.value(changed) == 0.0) continue;
    const double value = path.value(changed);
    add_cause({nullptr, std::nullopt, std::string(path.table) + "." + std::string(path.key), std::string(path.unit),
               value, 0.0, INFINITY, false, thresholds::described_value},
              {(1.0 + part) * value}, bare_);
  }
  describe_rig();
}

void Twins::describe_sensors() {
  for (const Channel channel : channels_) {
    if (!identification::has_sensor_effect(rig_, channel)) continue;
    sensors_.push_back({channel, sensor_of(rig_, channel, like_.period)});
  }
}

void Twins::describe_rig() {
  described_.try_emplace(1, bare_, like_, 1, channels_);
  for (const Neighbour& neighbour : neighbours_) {
    described_.try_emplace(neighbour.substeps, bare_, like_, neighbour.substeps, channels_);
  }
}

Twins Twins::at(const std::vector<std::pair<std::size_t, double>>& values) const {
  Twins others;
  others.rig_ = rig_;
  others.bare_ = bare_;
  others.like_ = like_;
  others.input_sensor_ = input_sensor_;
  others.channels_ = channels_;
  others.describe_sensors();
  for (const auto& [cause, value] : values) others.add_cause(causes_[cause], {value}, bare_);
  others.describe_rig();
  return others;
}

void Twins::add(const identification::Candidate& found) {
  // A score test has one direction: of effects with several parameters the shape is not known.
  const firmware::CatalogueEntry& entry = *found.entry;
  if (entry.parameters.size() != 1 || entry.parameters[0].starts.read != model::Reading::nothing) return;
  const auto& card = entry.parameters[0];
  std::vector<double> values;
  for (const identification::Start& start : found.starts) values.push_back(start.values[0]);
  add_cause({&entry, found.channel, firmware::effect_path({&entry, found.channel, {values.front()}}, 0),
             unit_of(card, found.channel), card.neutral, card.lower, card.upper, card.lower > card.neutral},
            values, bare_);
}

bool Twins::can_step(const Rig& rig, int substeps) const {
  return !firmware::find_rig_fault(rig, like_.period / substeps).has_value();
}

void Twins::add_cause(Cause cause, const std::vector<double>& values, const Rig& bare) {
  std::vector<Neighbour> made;
  std::vector<Candidate> sizes;
  for (const double value : values) {
    const std::size_t number = candidates_.size() + sizes.size();
    Neighbour neighbour{.candidate = number};
    if (cause.channel) {
      Rig changed = rig_;
      firmware::put_effect(changed, {cause.entry, cause.channel, {value}});
      neighbour.sensor = Sensor{*cause.channel, sensor_of(changed, *cause.channel, like_.period)};
      neighbour.of_input = cause.channel == input_sensor_;
      if (!neighbour.of_input && std::find(channels_.begin(), channels_.end(), *cause.channel) == channels_.end()) {
        continue;
      }
      if (neighbour.of_input) {
        Rig alone;  // the effect itself: what the description has of that sensor is not undone here
        alone.kind = rig_.kind;
        firmware::put_effect(alone, {cause.entry, cause.channel, {value}});
        neighbour.sensor->path = sensor_of(alone, *cause.channel, like_.period);
        neighbour.simulation.emplace(bare, like_, 1, channels_);
      }
    } else {
      Rig changed = bare;
      if (cause.entry != nullptr) {
        firmware::put_effect(changed, {cause.entry, std::nullopt, {value}});
      } else {
        *firmware::find_parameter(changed, cause.path) = value;
      }
      neighbour.substeps = steps_of(changed, like_.period, fine_steps(like_.period));
      if (!can_step(changed, neighbour.substeps)) continue;
      neighbour.simulation.emplace(changed, like_, neighbour.substeps, channels_);
    }
    sizes.push_back({causes_.size(), value - cause.described});
    made.push_back(std::move(neighbour));
  }
  if (sizes.empty()) return;
  causes_.push_back(std::move(cause));
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    candidates_.push_back(sizes[i]);
    neighbours_.push_back(std::move(made[i]));
  }
}

std::vector<Tested> Twins::tested() const {
  std::vector<Tested> all;
  for (const Candidate& candidate : candidates_) {
    const Cause& cause = causes_[candidate.cause];
    if (cause.inverse) {
      all.push_back({candidate.cause, 0.0, candidate.step / cause.lower, cause.price});
      continue;
    }
    const double a = (cause.lower - cause.described) / candidate.step;
    const double b = (cause.upper - cause.described) / candidate.step;
    all.push_back({candidate.cause, std::min(a, b), std::max(a, b), cause.price});
  }
  return all;
}

SimulationInput Twins::input_of(const Block& block) const { return simulation_input(rig_, block.recording); }

void Twins::start(const Block& block) {
  const SimulationInput input = input_of(block);
  for (auto& [substeps, simulation] : described_) simulation.start(input, block.from);
  for (Sensor& sensor : sensors_) sensor.started = false;
  for (Neighbour& neighbour : neighbours_) {
    if (neighbour.sensor) neighbour.sensor->started = false;
    neighbour.passed.clear();
    if (neighbour.simulation) neighbour.simulation->start(input, block.from);
  }
}

void Twins::pass(Sensor& sensor, std::vector<double>& values) {
  model::Signals<double> signals{};
  for (double& value : values) {
    signals[index(sensor.channel)] = value;
    if (!sensor.started) {
      sensor.path.start(sensor.state, signals, nullptr);
      sensor.started = true;
    } else {
      sensor.path.step(sensor.state, signals, nullptr);
    }
    value = sensor.path.reading(sensor.state, sensor.channel, value);
  }
}

Response Twins::through_sensors(const Response& truth) {
  Response readings = truth;
  for (Sensor& sensor : sensors_) pass(sensor, readings[index(sensor.channel)]);
  return readings;
}

const Response& Twins::describe(const Block& block) {
  const SimulationInput input = input_of(block);
  for (auto& [substeps, simulation] : described_) simulation.run(input, block.from, block.to, truths_[substeps]);
  readings_ = through_sensors(truths_.rbegin()->second);
  return readings_;
}

SimulationInput Twins::passed(Neighbour& neighbour, const Block& block, const SimulationInput& input) {
  const std::vector<double>& read = block.recording[input.channel];
  std::vector<double> fresh = read;
  if (!neighbour.passed.empty()) {  // the margins of blocks overlap
    neighbour.passed.erase(neighbour.passed.begin(),
                           neighbour.passed.begin() + static_cast<std::ptrdiff_t>(block.size()));
    fresh.erase(fresh.begin(), fresh.begin() + static_cast<std::ptrdiff_t>(neighbour.passed.size()));
  }
  pass(*neighbour.sensor, fresh);
  neighbour.passed.insert(neighbour.passed.end(), fresh.begin(), fresh.end());
  SimulationInput changed = input;
  changed.motion = motion_between(input.deflection_reached, neighbour.passed, 1.0 / input.period);
  if (input.channel == Channel::z_r) {  // its acceleration has a sensor of its own, where there is one
    for (std::size_t k = 0; k < changed.size(); ++k) changed.motion[k].acceleration = input.motion[k].acceleration;
  }
  return changed;
}

BlockScore Twins::score(const Block& block, const Residuals& residuals) {
  const SimulationInput input = input_of(block);
  static_cast<void>(describe(block));
  BlockScore result;
  result.score.assign(candidates_.size(), 0.0);
  result.information.assign(candidates_.size(), 0.0);
  result.begins = block.begins;
  result.ends = block.ends;
  Response left;  // r/σ², 0 where nothing is compared
  for (const Channel channel : channels_) {
    const auto c = index(channel);
    const auto& measured = block.recording[channel];
    auto& weighted = left[c];
    weighted.assign(block.size(), 0.0);
    if (measured.empty()) continue;
    const double weight = 1.0 / (residuals[c].deviation * residuals[c].deviation);
    for (std::size_t k = 0; k < block.size(); ++k) {
      if (block.unused[c][k] != 0) continue;
      const double r = measured[block.from + 1 + k] - readings_[c][k] - residuals[c].mean;
      weighted[k] = r * weight;
      result.power += r * r * weight;
      result.samples += 1.0;
    }
  }
  Response moved;
  const auto add = [&](std::size_t candidate, Channel channel, const std::vector<double>& with,
                       const std::vector<double>& without, double sign) {
    const auto c = index(channel);
    if (block.recording[channel].empty()) return;
    const double weight = 1.0 / (residuals[c].deviation * residuals[c].deviation);
    for (std::size_t k = 0; k < block.size(); ++k) {
      if (block.unused[c][k] != 0) continue;
      const double g = sign * (with[k] - without[k]);
      result.score[candidate] += g * left[c][k];
      result.information[candidate] += g * g * weight;
    }
  };
  for (Neighbour& neighbour : neighbours_) {
    const Response& truth = truths_[neighbour.substeps];
    if (neighbour.sensor && !neighbour.of_input) {
      const Channel channel = neighbour.sensor->channel;
      std::vector<double> with = truths_.rbegin()->second[index(channel)];
      pass(*neighbour.sensor, with);
      add(neighbour.candidate, channel, with, readings_[index(channel)], 1.0);
      continue;
    }
    if (neighbour.of_input) {
      neighbour.simulation->run(passed(neighbour, block, input), block.from, block.to, moved);
    } else {
      neighbour.simulation->run(input, block.from, block.to, moved);
    }
    for (const Channel channel : channels_) {
      add(neighbour.candidate, channel, moved[index(channel)], truth[index(channel)], neighbour.of_input ? -1.0 : 1.0);
    }
  }
  return result;
}

}  // namespace host_sim::live
