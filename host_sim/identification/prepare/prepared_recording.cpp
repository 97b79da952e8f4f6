#include "host_sim/identification/prepare/prepared_recording.hpp"

#include <cmath>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/comparison/start_state.hpp"
#include "host_sim/identification/prepare/driving_input.hpp"
#include "host_sim/identification/prepare/input_fusion.hpp"
#include "host_sim/identification/prepare/smoothed_input.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;
using model::RigKind;

namespace {

/// The two sensors of the foot point; nullopt where they are not both recorded, or one is without noise.
struct FootSensors {
  double position_noise, acceleration_noise;  ///< at every sample
  std::vector<double> acceleration;           ///< not a number where clipped
};
std::optional<FootSensors> foot_sensors(const firmware::RigDescription& description, const SampledRecording& sampled) {
  const firmware::Recording& recording = sampled.recording;
  if (description.rig.kind != RigKind::quarter_car || recording.has(Channel::z_cmd)) return std::nullopt;
  if (!recording.has(Channel::z_r) || !recording.has(Channel::zdd_r)) return std::nullopt;
  FootSensors sensors{sampled.noise_at_every_sample(Channel::z_r), sampled.noise_at_every_sample(Channel::zdd_r),
                      recording[Channel::zdd_r]};
  if (!(sensors.position_noise > 0.0) || !(sensors.acceleration_noise > 0.0)) return std::nullopt;
  const std::vector<bool>& clipped = sampled.clipped[index(Channel::zdd_r)];
  for (std::size_t k = 0; k < clipped.size(); ++k) {
    if (clipped[k]) sensors.acceleration[k] = std::nan("");
  }
  return sensors;
}

/// f_e of a measured displacement [Hz]; 0: nothing is to be taken away.
double edge_of_input(const SampledRecording& sampled, Channel input) {
  const auto& renewals = sampled.renewals[index(input)];
  const double noise = sampled.noise[index(input)];
  if ((renewals && renewals->regular) || !(noise > 0.0)) return 0.0;
  const firmware::Recording& recording = sampled.recording;
  return edge_of_motion(recording[input], {noise, sampled.channel_noise[index(input)].colour}, recording.sample_period,
                        sampled.step)
      .value_or(0.0);
}

void prepare_input(PreparedRecording& prepared, const firmware::RigDescription& description,
                   const SampledRecording& sampled, bool disagree) {
  const firmware::Recording& recording = sampled.recording;
  const Channel input = prepared.input.channel;
  if (input == Channel::x_cmd || input == Channel::z_cmd) return;  // computed, without noise
  const bool integrated = input == Channel::zdd_r || input == Channel::zdd_w;
  InputNoise& noise = prepared.input_noise;
  (integrated ? noise.acceleration : noise.position) = sampled.noise[index(input)];
  noise.position_colour = noise.acceleration_colour = sampled.channel_noise[index(input)].colour;
  noise.sample_period = recording.sample_period * static_cast<double>(sampled.step);
  prepared.mean_unknown = integrated;
  const double h = recording.sample_period;
  const auto sensors = foot_sensors(description, sampled);
  if (!sensors) {
    if (integrated) return;
    prepared.input_edge = edge_of_input(sampled, input);
    if (prepared.input_edge > 0.0) prepared.input.motion = prepared.motion_of_input(recording[input]);
    return;
  }
  prepared.inputs_disagree = disagree;
  if (disagree) {
    prepared.acceleration_known =
        known_up_to(recording[Channel::z_r], {noise.position, noise.position_colour}, h, prepared.step);
    prepared.input_edge = smoothing_edge(prepared.acceleration_known);
    prepared.input.motion = prepared.motion_of_input(recording[Channel::z_r]);
    return;
  }
  prepared.input.motion =
      firmware::through_samples(fused_displacement(recording[Channel::z_r], sensors->acceleration,
                                                   sensors->position_noise, sensors->acceleration_noise, h),
                                1.0 / h);
  prepared.inputs_fused = true;
  noise.acceleration = sampled.noise[index(Channel::zdd_r)];
  noise.acceleration_colour = sampled.channel_noise[index(Channel::zdd_r)].colour;
}

/// Samples of F are not used while the command of a hil rig stands still. The stroke of its virtual car does so where the
/// component sticks, and the force is then what the car asks for, anything up to the friction: (1) no function of the
/// stroke. Two samples on either side: so far a cubic through the samples feels the standstill.
///
///   (1)  |x_{k+1} − x_k| ≤ 1e-9 max|x|        the nine digits of a recording
void leave_out_standstill(const firmware::Recording& recording, PreparedRecording& prepared) {
  const std::vector<double>& command = recording[Channel::x_cmd];
  constexpr double digits = 1e-9;
  constexpr std::size_t reach = 2;
  const auto less = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const double still =
      command.empty() ? 0.0 : digits * std::abs(*std::max_element(command.begin(), command.end(), less));
  if (!(still > 0.0)) return;  // it never moves
  std::vector<bool>& unused = prepared.clipped[index(Channel::F)];
  unused.resize(command.size(), false);
  for (std::size_t k = 0; k + 1 < command.size(); ++k) {
    if (std::abs(command[k + 1] - command[k]) > still) continue;
    for (std::size_t i = k - std::min(k, reach); i <= std::min(k + 1 + reach, command.size() - 1); ++i) {
      if (!unused[i]) ++prepared.stuck;
      unused[i] = true;
    }
  }
}

/// Whether the samples that may be used differ: of what never moves inside its measuring range nothing is known.
bool moves(const std::vector<double>& samples, const std::vector<bool>& clipped, std::size_t step) {
  const double* first = nullptr;
  for (std::size_t k = 0; k < samples.size(); k += step) {
    if (!clipped.empty() && clipped[k]) continue;
    if (first == nullptr) first = &samples[k];
    if (samples[k] != *first) return true;
  }
  return false;
}

void split(PreparedRecording& prepared, Use use, std::size_t samples) {
  const std::size_t step = prepared.step;
  std::size_t end = samples;
  if (use == Use::shared) end -= samples / thresholds::held_out_part;
  if (use == Use::held_out) end = 0;
  if (end < samples) end = end / step * step;
  prepared.fitted = {0, end};
  prepared.held_out = {end, samples};
  if (use == Use::held_out && !prepared.at_rest) {  // in a fitted recording this is a small part
    prepared.held_out.from =
        prepared.compared_from(static_cast<std::size_t>(thresholds::forgets_start / prepared.input.period));
  }
}

}  // namespace

bool PreparedRecording::shows(std::string_view parameter_path) const {
  if (!input.wheel_prescribed) return true;
  if (parameter_path.starts_with("tyre.")) return false;
  return !parameter_path.starts_with("wheel.") || explains(Channel::F_w);
}

bool PreparedRecording::shows(const firmware::CatalogueEntry& effect) const {
  if (!input.wheel_prescribed || effect.of_channel) return true;
  if (effect.subsystem == model::Subsystem::wheel_guide) return explains(Channel::F_w);
  return effect.subsystem != model::Subsystem::tyre && effect.subsystem != model::Subsystem::sensor;
}

std::optional<Channel> PreparedRecording::input_sensor() const {
  if (input.channel == Channel::x_cmd || input.channel == Channel::z_cmd || inputs_fused || channels.size() < 2)
    return std::nullopt;
  return input.channel;
}

firmware::FootPointMotion PreparedRecording::motion_of_input(const std::vector<double>& samples) const {
  if (!(input_edge > 0.0)) return motion_of(input.channel, samples, input.period);
  return motion_of(input.channel, smoothed(samples, input_edge, input.period), input.period);
}

void smooth_input(const firmware::RigDescription& description, const firmware::Recording& recorded,
                  const firmware::Recording& simulated, SimulationInput& input) {
  const bool bench = description.rig.kind == RigKind::component_bench && input.channel == Channel::x_act;
  const bool car = description.rig.kind == RigKind::quarter_car && input.channel == Channel::z_r;
  if (!bench && !(car && !recorded.has(Channel::zdd_r))) return;
  const double duration = recorded.sample_period * static_cast<double>(recorded.size());
  if (duration < 2.0 * thresholds::smoothing_reach) return;
  const double edge = edge_of_input(sampled(description, recorded), input.channel);
  if (edge > 0.0) {
    input.motion = motion_of(input.channel, smoothed(simulated[input.channel], edge, input.period), input.period);
  }
}

Window PreparedRecording::comparable(Channel channel, Window window) const {
  if (channel != Channel::zdd_r || !(acceleration_known > 0.0)) return window;
  const auto margin = static_cast<std::size_t>(thresholds::smoothing_reach / input.period);
  window.from = std::max(window.from, margin);
  window.to = std::max(window.from, std::min(window.to, size() - std::min(size(), margin)));
  return window;
}

model::RigParameters<double> explained_part(const model::RigParameters<double>& rig) {
  if (rig.kind != RigKind::hil) return rig;
  model::RigParameters<double> part = rig;
  part.kind = RigKind::component_bench;
  part.machine.virtual_damping = 0.0;
  part.lever = {};  // x_cmd and F are the component's
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

bool inputs_disagree(const firmware::RigDescription& description, const SampledRecording& sampled) {
  const auto sensors = foot_sensors(description, sampled);
  const auto& held = sampled.renewals[index(Channel::zdd_r)];
  if (sensors && held && held->regular) return true;
  return sensors && disagree(sampled.recording[Channel::z_r], sensors->acceleration, sensors->position_noise,
                             sensors->acceleration_noise, sampled.recording.sample_period, sampled.step);
}

PreparedRecording prepare_recording(const firmware::RigDescription& description, firmware::Recording recording, Use use,
                                    bool disagree) {
  return prepare_recording(description, sampled(description, std::move(recording)), use, disagree);
}

PreparedRecording prepare_recording(const firmware::RigDescription& description, SampledRecording sampled, Use use,
                                    bool disagree) {
  const firmware::Recording& recording = sampled.recording;
  const double duration = recording.sample_period * static_cast<double>(recording.size());
  if (duration < thresholds::shortest_recording) {
    throw firmware::InputError(recording.source, 0, "the recording lasts " + firmware::shortest(duration) + " s",
                               "at least " + firmware::shortest(thresholds::shortest_recording) + " s");
  }
  const model::RigParameters<double> rig = explained_part(description.rig);
  PreparedRecording prepared;
  prepared.input = driving_input(rig, recording);
  prepared.step = sampled.step;
  prepared.noise = sampled.noise;
  prepared.substeps = fine_steps(prepared.input.period, sampled.slower);
  prepare_input(prepared, description, sampled, disagree);
  // Without its mean an acceleration does not begin at rest, even where the rig did.
  prepared.at_rest = !prepared.mean_unknown && begins_at_rest(rig, prepared.input, recording);
  const bool has_machine = prepared.input.channel == Channel::x_cmd;
  prepared.settles = use == Use::held_out && has_machine && !rig.has_fdva && !prepared.at_rest;
  std::vector<Channel> simulated = response_channels(rig.kind, prepared.input);
  if (prepared.inputs_disagree) simulated.push_back(Channel::zdd_r);
  // A sensor of F_w that feels the road's acceleration says nothing where that is not known.
  const auto described = firmware::effects_of(rig);
  const bool feels_road = std::any_of(described.begin(), described.end(), [&](const auto& placed) {
    return !prepared.shows(*placed.entry) && placed.entry->subsystem == model::Subsystem::sensor;
  });
  if (feels_road) std::erase(simulated, Channel::F_w);
  for (const Channel channel : simulated) {
    const auto c = index(channel);
    if (!recording.has(channel) || !moves(recording[channel], sampled.clipped[c], sampled.step)) continue;
    prepared.channels.push_back(channel);
    prepared.renewals[c] = std::move(sampled.renewals[c]);
    prepared.clipped[c] = std::move(sampled.clipped[c]);
  }
  if (description.rig.kind == RigKind::hil && prepared.explains(Channel::F)) leave_out_standstill(recording, prepared);
  const std::optional<Channel> driving = prepared.input_sensor();
  if (driving && sampled.renewals[index(*driving)] && sampled.renewals[index(*driving)]->regular) {
    prepared.renewals[index(*driving)] = std::move(sampled.renewals[index(*driving)]);
    // A value stands for all samples up to the next: so does its noise, which is that much stronger below.
    const double samples = prepared.renewals[index(*driving)]->period / static_cast<double>(prepared.step);
    prepared.input_noise.position *= std::sqrt(samples);
    prepared.input_noise.acceleration *= std::sqrt(samples);
  }
  prepared.outliers = sampled.outliers;
  prepared.rounding = sampled.rounding;
  prepared.channel_noise = sampled.channel_noise;
  prepared.declared_noise = description.noise;
  prepared.range = description.range;
  prepared.tared = std::move(sampled.tared);
  for (const StaticValue& value : prepared.tared) {
    auto& range = prepared.range[index(value.channel)];
    if (range) range = firmware::MeasuringRange{range->lower - value.value, range->upper - value.value};
  }
  prepared.expected_colour = sampled.expected_colour;
  std::vector<Channel> sensors = prepared.channels;
  if (rig.kind == model::RigKind::driven_mass) sensors.push_back(Channel::F);
  if (rig.kind == model::RigKind::quarter_car) sensors.insert(sensors.end(), {Channel::z_r, Channel::zdd_r});
  for (const Channel channel : sensors) prepared.noise_factor[index(channel)] = sampled.noise_factor[index(channel)];
  if (prepared.channels.empty()) {
    throw firmware::InputError(recording.source, 0, "nothing is measured that the model could explain",
                               "one channel at least beside the input");
  }
  split(prepared, use, recording.size());
  prepared.recording = std::move(sampled.recording);
  return prepared;
}

}  // namespace host_sim::identification
