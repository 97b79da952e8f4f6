#include "host_sim/identification/prepare/sampled_recording.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <utility>

#include "host_sim/comparison/model_rate.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/signal/spectrum.hpp"

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
  if (kind == model::RigKind::quarter_car || kind == model::RigKind::driven_mass) return false;
  return channel != model::Channel::x_act && channel != model::Channel::F;
}

/// Every n-th of these.
Flags picked(const Flags& flags, std::size_t n) {
  Flags fewer;
  for (std::size_t k = 0; k < flags.size(); k += n) fewer.push_back(flags[k]);
  return fewer;
}

/// Whether a recorder can strike samples of a channel: a program's own numbers are as they are, and so is a command to
/// an actuator, which may jump.
bool may_have_outliers(model::RigKind kind, model::Channel channel) {
  if (channel == model::Channel::F_act) return false;
  return kind != model::RigKind::hil || !is_computed(kind, channel);
}

/// Steps of rounding, as the samples show them; 0: none.
using Steps = std::array<double, model::channel_count>;

Steps quantisation_steps(model::RigKind kind, const firmware::Recording& recording) {
  Steps steps{};
  for (std::size_t c = 0; c < steps.size(); ++c) {
    const model::Channel channel = model::channel_at(c);
    if (!recording.has(channel) || is_computed(kind, channel) || channel == model::Channel::F_act) continue;
    std::vector<double> recorded;
    for (std::size_t k = 0; k < recording.size(); ++k) {
      if (recording.filled.empty() || !recording.filled[k]) recorded.push_back(recording[channel][k]);
    }
    steps[c] = quantisation_step(std::move(recorded));
  }
  return steps;
}

/// Whether a channel beside `channel` leaves its course where it has an outlier.
bool shows_elsewhere(const std::vector<std::vector<double>>& deviations, std::size_t channel, std::size_t at) {
  for (std::size_t other = 0; other < deviations.size(); ++other) {
    if (other == channel) continue;
    for (std::size_t k = at > 0 ? at - 1 : 0; k < std::min(at + 2, deviations[other].size()); ++k) {
      if (std::abs(deviations[other][k]) > thresholds::shows_in_another) return true;
    }
  }
  return false;
}

/// True if the outliers of a force or an acceleration are motion: they come only where another channel has certain
/// values. When free play is crossed, for example, the force is zero for a few samples. Outliers of a displacement are
/// never taken for motion, since a potentiometer may be worn at one place.
bool go_with_motion(const firmware::Recording& recording, model::Channel channel,
                    const std::vector<std::size_t>& places) {
  if (places.empty() || model::unit(channel) == "m") return false;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel other = model::channel_at(c);
    if (other == channel || !recording.has(other)) continue;
    if (place_deviation(recording[other], places) > thresholds::places_of_motion) return true;
  }
  return false;
}

/// The outliers of each channel are marked in `unusable` and mended; one sample in `fewer` is kept afterwards.
std::array<Outliers, model::channel_count> leave_out_outliers(model::RigKind kind, firmware::Recording& recording,
                                                              const Steps& steps, std::size_t fewer,
                                                              std::array<Flags, model::channel_count>& unusable) {
  std::array<std::vector<std::size_t>, model::channel_count> places;
  std::vector<std::vector<double>> deviations(model::channel_count);
  for (std::size_t c = 0; c < places.size(); ++c) {
    const model::Channel channel = model::channel_at(c);
    if (!recording.has(channel) || !may_have_outliers(kind, channel)) continue;
    if (renewals_of(recording[channel], steps[c], recording.filled)) continue;
    places[c] = find_outliers(recording[channel], unusable[c], steps[c]);
    if (recording.sample_period < thresholds::knock_length) continue;
    deviations[c] = relative_deviations(recording[channel], unusable[c], steps[c]);
  }
  std::array<Outliers, model::channel_count> outliers;
  for (std::size_t c = 0; c < places.size(); ++c) {
    std::erase_if(places[c], [&](std::size_t k) { return shows_elsewhere(deviations, c, k); });
    if (go_with_motion(recording, model::channel_at(c), places[c])) places[c].clear();
    if (places[c].empty()) continue;
    outliers[c].count = places[c].size();
    for (const std::size_t k : places[c]) {
      if (k % fewer != 0) continue;
      outliers[c].at.push_back(k / fewer);
      outliers[c].values.push_back(recording.channels[c][k]);
    }
    mend_outliers(recording.channels[c], places[c], unusable[c]);
    unusable[c].resize(recording.size(), false);
    for (const std::size_t k : places[c]) unusable[c][k] = true;
  }
  return outliers;
}

/// Median over the lines above the motion of the coherence of two channels, |S_ab|²/(S_aa S_bb); 0: too few samples.
double coherence_above_motion(const std::vector<double>& a, const std::vector<double>& b, double period) {
  constexpr std::size_t fewest_blocks = 8;
  const double rate = 1.0 / period;
  const std::size_t wanted = std::min(static_cast<std::size_t>(rate), 2 * a.size() / (fewest_blocks + 1));
  if (wanted < 32) return 0.0;
  const std::size_t length = good_fft_size_at_most(wanted);
  BlockTransform transform(hann_window(length), Detrend::line);
  std::vector<double> aa(transform.bins(), 0.0), bb = aa;
  std::vector<std::complex<double>> ab(transform.bins(), 0.0);
  for (std::size_t from = 0; from + length <= a.size(); from += length / 2) {
    const auto of_a = transform(std::span(a).subspan(from, length));
    const std::vector<std::complex<double>> kept(of_a.begin(), of_a.end());
    const auto of_b = transform(std::span(b).subspan(from, length));
    for (std::size_t k = 0; k < kept.size(); ++k) {
      aa[k] += std::norm(kept[k]);
      bb[k] += std::norm(of_b[k]);
      ab[k] += std::conj(kept[k]) * of_b[k];
    }
  }
  const double first = std::min(thresholds::noise_begins, thresholds::noise_begins_share * rate);
  std::vector<double> coherences;
  for (std::size_t k = 0; k < aa.size(); ++k) {
    const double f = static_cast<double>(k) * rate / static_cast<double>(length);
    if (f < first || f > thresholds::noise_ends_share * rate) continue;
    if (aa[k] > 0.0 && bb[k] > 0.0) coherences.push_back(std::norm(ab[k]) / (aa[k] * bb[k]));
  }
  if (coherences.empty()) return 0.0;
  const auto middle = coherences.begin() + static_cast<std::ptrdiff_t>(coherences.size() / 2);
  std::nth_element(coherences.begin(), middle, coherences.end());
  return *middle;
}

/// Noise of two sensors is not coherent, the tail of a motion is: where the spectra of two channels whose noise nobody
/// declared are one motion above the frequencies that are driven, only the rest can be noise.
void leave_motion_out(SampledRecording& result, const firmware::RigDescription& description,
                      const firmware::Recording& recording) {
  std::vector<std::size_t> open;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel channel = model::channel_at(c);
    const bool is_measured = channel != model::Channel::F_act && !is_computed(description.rig.kind, channel);
    const bool is_open = is_measured && recording.has(channel) && !description.noise[c] && !result.renewals[c];
    if (is_open && result.channel_noise[c].level > 0.0) open.push_back(c);
  }
  std::array<double, model::channel_count> most{};
  for (std::size_t i = 0; i < open.size(); ++i) {
    for (std::size_t j = i + 1; j < open.size(); ++j) {
      const double coherence =
          coherence_above_motion(recording.channels[open[i]], recording.channels[open[j]], recording.sample_period);
      most[open[i]] = std::max(most[open[i]], coherence);
      most[open[j]] = std::max(most[open[j]], coherence);
    }
  }
  for (const std::size_t c : open) {
    if (most[c] < thresholds::coherent_motion) continue;
    const double least = exactness_of_model(recording.channels[c], recording.filled);
    const double rest = result.channel_noise[c].level * std::sqrt(1.0 - most[c]);
    result.channel_noise[c] = {std::max(least, rest), {}, thresholds::grid_error, 0.0, 0.0};
    result.noise[c] = result.channel_noise[c].level;
  }
}

/// A force that drives a mass is made: it may reach any frequency, and the mass answers there. So its spectrum says
/// nothing of its noise, nor that of an answer which is one motion with it above the frequencies that a road drives:
/// what is declared is believed.
void believe_declared(SampledRecording& result, const firmware::RigDescription& description,
                      const firmware::Recording& recording, const Steps& steps) {
  if (description.rig.kind != model::RigKind::driven_mass || !recording.has(model::Channel::F)) return;
  for (const model::Channel channel : {model::Channel::F, model::Channel::x_act, model::Channel::zdd_b}) {
    const std::size_t c = index(channel);
    if (!description.noise[c] || !recording.has(channel) || result.renewals[c]) continue;
    const bool one_motion =
        channel == model::Channel::F || coherence_above_motion(recording[model::Channel::F], recording[channel],
                                                               recording.sample_period) >= thresholds::coherent_motion;
    if (!one_motion) continue;
    const double level = std::hypot(*description.noise[c], rounding_noise(steps[c]));
    result.channel_noise[c] = {level, {}, thresholds::grid_error, 0.0, 0.0};
    result.noise[c] = level;
    result.noise_factor[c].reset();
  }
}

/// What speaks for a filter of the recorder: not a channel whose noise nobody declared, where declared noise of a
/// position is white. Its own spectrum may be the tail of its motion.
ChannelNoises witnesses(const SampledRecording& result, const firmware::RigDescription& description) {
  ChannelNoises all = result.channel_noise;
  const auto is_white = [&](std::size_t c) {
    const bool position = model::unit(model::channel_at(c)) == "m";
    return position && description.noise[c] && all[c].level > 0.0 && all[c].is_known() && all[c].colour.is_white();
  };
  bool any_white = false;
  for (std::size_t c = 0; c < all.size(); ++c) any_white = any_white || is_white(c);
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (any_white && !description.noise[c]) all[c] = {};
  }
  return all;
}

/// The noise of everything that is measured: each channel by itself, then those whose colour is not clear once more
/// with that of the others.
void find_noise(SampledRecording& result, const firmware::RigDescription& description,
                const firmware::Recording& recording, const Steps& steps) {
  for (const bool again : {false, true}) {
    if (again && !result.expected_colour) break;
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      const model::Channel channel = model::channel_at(c);
      if (!recording.has(channel)) continue;
      const ChannelNoise& before = result.channel_noise[c];
      if (again && before.is_known() && before.colour.is_white()) continue;
      const SensorNoise found = find_sensor_noise(description, recording, channel, result.expected_colour, steps[c]);
      result.rounding[c] = found.rounded ? steps[c] : 0.0;
      result.channel_noise[c] = found.noise;
      result.noise_factor[c] = found.factor;
      result.noise[c] = found.noise.level;
    }
    if (!again) leave_motion_out(result, description, recording);
    believe_declared(result, description, recording, steps);
    ChannelNoises measured = witnesses(result, description);
    for (std::size_t c = 0; c < measured.size(); ++c) {
      const model::Channel channel = model::channel_at(c);
      const bool drives = description.rig.kind == model::RigKind::driven_mass && channel == model::Channel::F;
      if (drives || is_computed(description.rig.kind, channel)) measured[c] = {};
    }
    result.expected_colour = expected_colour(measured);
  }
}

void interpolate(SampledRecording& sampled, model::RigKind kind) {
  const double longest = longest_step(kind, sampled.recording);
  sampled.step = model_steps_per_sample(sampled.recording.sample_period, longest);
  sampled.slower = longest / longest_model_step;
  if (sampled.step == 1) return;
  sampled.recording = interpolated(sampled.recording, sampled.step);
  const auto step = static_cast<double>(sampled.step);
  for (std::size_t c = 0; c < sampled.clipped.size(); ++c) {
    for (std::size_t& k : sampled.outliers[c].at) k *= sampled.step;
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
  const model::RigKind kind = description.rig.kind;
  const std::size_t fewer = samples_per_kept(recording.sample_period);
  SampledRecording result;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel channel = model::channel_at(c);
    if (recording.has(channel)) result.clipped[c] = clipped_samples(description, recording, channel);
  }
  result.tared = static_values(description.rig, recording, result.clipped);
  tare(result.tared, recording);
  const Steps steps = quantisation_steps(kind, recording);
  result.outliers = leave_out_outliers(kind, recording, steps, fewer, result.clipped);
  if (fewer > 1) {
    recording = picked(recording, fewer);
    for (Flags& clipped : result.clipped) clipped = picked(clipped, fewer);
  }
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel channel = model::channel_at(c);
    if (recording.has(channel)) result.renewals[c] = renewals_of(recording[channel], steps[c], recording.filled);
  }
  find_noise(result, description, recording, steps);
  result.recording = std::move(recording);
  interpolate(result, kind);
  return result;
}

firmware::Recording at_simulated_rate(firmware::Recording recording) {
  const std::size_t fewer = samples_per_kept(recording.sample_period);
  if (fewer > 1) return picked(recording, fewer);
  return interpolated(recording, model_steps_per_sample(recording.sample_period));
}

}  // namespace host_sim::identification
