#include "host_sim/diagnose/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/diagnose/foot_point.hpp"
#include "host_sim/diagnose/golden_section.hpp"
#include "host_sim/input_error.hpp"

namespace host_sim::diagnose {

using model::Channel;
using model::RigKind;

double estimated_noise(const std::vector<double>& samples) {
  constexpr std::array<double, 7> weights{1, -6, 15, -20, 15, -6, 1};
  double gain = 0.0;  // Σ weights²: of the variance of white noise
  for (const double w : weights) gain += w * w;
  constexpr std::size_t stretch = 64;
  std::vector<double> variances;
  for (std::size_t from = 0; from + stretch + weights.size() <= samples.size(); from += stretch) {
    double squares = 0.0;
    for (std::size_t k = from; k < from + stretch; ++k) {
      double difference = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i) difference += weights[i] * samples[k + i];
      squares += difference * difference;
    }
    variances.push_back(squares / (stretch * gain));
  }
  if (variances.empty()) return 0.0;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return std::sqrt(*middle);
}

double noise_of(const RigDescription& description, const Recording& recording, Channel channel) {
  if (const auto& given = description.noise[index(channel)]) return *given;
  const auto& samples = recording[channel];
  const auto renewals = renewals_of(samples);
  if (!renewals) return estimated_noise(samples);
  std::vector<double> renewed;
  for (const std::size_t k : renewals->at) renewed.push_back(samples[k]);
  return estimated_noise(renewed);
}

model::RigParameters<double> explained_part(const model::RigParameters<double>& rig) {
  if (rig.kind != RigKind::hil) return rig;
  model::RigParameters<double> part = rig;
  part.kind = RigKind::component_bench;
  part.machine.virtual_damping = 0.0;
  return part;
}

namespace {

/// What z_r and zdd_r say of the foot point; nullopt where they are not both there, or one is without noise.
struct FootSensors {
  double position_noise, acceleration_noise;
  std::vector<double> acceleration;  ///< not a number where clipped
};
std::optional<FootSensors> foot_sensors(const RigDescription& description, const Recording& recording) {
  if (description.rig.kind != RigKind::quarter_car) return std::nullopt;
  if (!recording.has(Channel::z_r) || !recording.has(Channel::zdd_r)) return std::nullopt;
  FootSensors sensors{noise_of(description, recording, Channel::z_r), noise_of(description, recording, Channel::zdd_r),
                      recording[Channel::zdd_r]};
  if (!(sensors.position_noise > 0.0) || !(sensors.acceleration_noise > 0.0)) return std::nullopt;
  if (const auto& range = description.range[index(Channel::zdd_r)]) {
    for (double& a : sensors.acceleration) a = range->holds(a) ? a : std::nan("");
  }
  return sensors;
}

void prepare_input(Evidence& evidence, const RigDescription& description, const Recording& recording, bool disagree) {
  const Channel input = evidence.drive.channel;
  if (input == Channel::x_cmd) return;  // a number
  const double position_noise = noise_of(description, recording, input);
  evidence.input_noise.position = position_noise;
  const auto sensors = foot_sensors(description, recording);
  if (!sensors) return;
  const double h = recording.sample_period;
  evidence.inputs_disagree = disagree;
  if (disagree) {
    evidence.drive.motion = through_samples(recording[Channel::z_r], 1.0 / h);
    // Filtered a little above what is known, so that its edge is not.
    evidence.acceleration_known = known_up_to(recording[Channel::z_r], position_noise, h);
    smooth_acceleration(evidence.drive.motion, acceleration_edge * evidence.acceleration_known, h);
    return;
  }
  evidence.drive.motion = through_samples(fused_displacement(recording[Channel::z_r], sensors->acceleration,
                                                             position_noise, sensors->acceleration_noise, h),
                                          1.0 / h);
  evidence.input_noise.acceleration = sensors->acceleration_noise;
}

}  // namespace

std::optional<Renewals> renewals_of(const std::vector<double>& samples) {
  constexpr double held = 1.5;  // samples a value, to be a hold and not a chance
  Renewals r;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (samples[k] != samples[k - 1]) r.at.push_back(k);
  }
  if (r.at.size() < 3 || static_cast<double>(samples.size()) < held * static_cast<double>(r.at.size())) {
    return std::nullopt;
  }
  std::vector<std::size_t> gaps;
  for (std::size_t i = 1; i < r.at.size(); ++i) gaps.push_back(r.at[i] - r.at[i - 1]);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  // The mean of what is no gap of two turns: of gaps of 2 and 3 samples neither is the period.
  const std::size_t single = gaps[gaps.size() / 2] * 3 / 2;
  double sum = 0.0, count = 0.0;
  for (const std::size_t gap : gaps) {
    if (gap > single) continue;
    sum += static_cast<double>(gap);
    count += 1.0;
  }
  r.period = sum / count;
  const auto span = static_cast<double>(r.at.back() - r.at.front());
  for (int round = 0; round < 2; ++round) {
    r.turn.assign(1, 0.0);
    for (std::size_t i = 1; i < r.at.size(); ++i) {
      r.turn.push_back(r.turn.back() +
                       std::max(1.0, std::round(static_cast<double>(r.at[i] - r.at[i - 1]) / r.period)));
    }
    r.period = span / r.turn.back();
  }
  if (r.period < 0.95 * held) return std::nullopt;  // what stays long at one value now and then: a limit
  // Room for t_0 at a period: concave in it.
  const auto room = [&r](double period) {
    double lowest = -INFINITY, highest = INFINITY;
    for (std::size_t i = 0; i < r.at.size(); ++i) {
      const double start = static_cast<double>(r.at[i]) - r.turn[i] * period;
      lowest = std::max(lowest, start - 1.0);
      highest = std::min(highest, start);
    }
    return std::pair{lowest, highest};
  };
  const auto width = [&](double period) {
    const auto [lowest, highest] = room(period);
    return highest - lowest;
  };
  const double reach = 1.5 / r.turn.back();
  const double widest =
      golden_section([&](double period) { return -width(period); }, r.period - reach, r.period + reach, 60).at;
  if (width(widest) > 0.0) {
    r.regular = true;
    const auto border = [&](double outside) {
      double inside = widest;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (inside + outside);
        (width(middle) > 0.0 ? inside : outside) = middle;
      }
      return inside;
    };
    const double low = border(widest - 2.0 * reach), high = border(widest + 2.0 * reach);
    r.period = 0.5 * (low + high);
    r.period_slack = 0.5 * (high - low);
  } else {
    r.period_slack = 1.0 / r.turn.back();
  }
  const auto [lowest, highest] = room(r.period);
  r.first = 0.5 * (lowest + highest);
  r.slack = std::max(0.5 * (highest - lowest), 0.0);
  return r;
}

std::optional<HoldPeriod> hold_period(const std::vector<Evidence>& evidence, Channel channel) {
  double sum = 0.0, weights = 0.0, slack = INFINITY;
  for (const Evidence& e : evidence) {
    const auto& r = e.renewals[index(channel)];
    if (!r) continue;
    const double weight = r->turn.back();
    sum += weight * r->period * e.drive.period;
    weights += weight;
    slack = std::min(slack, r->period_slack * e.drive.period);
  }
  if (!(weights > 0.0)) return std::nullopt;
  return HoldPeriod{sum / weights, slack};
}

bool inputs_disagree(const RigDescription& description, const Recording& recording) {
  const auto sensors = foot_sensors(description, recording);
  return sensors && disagree(recording[Channel::z_r], sensors->acceleration, sensors->position_noise,
                             sensors->acceleration_noise, recording.sample_period);
}

Evidence evidence_of(const RigDescription& description, Recording recording, Use use, bool disagree) {
  const model::RigParameters<double> rig = explained_part(description.rig);
  constexpr double shortest = 5.0;  // [s]: some periods of a body mode, to fit and to judge
  const double duration = recording.sample_period * static_cast<double>(recording.size());
  if (duration < shortest) {
    throw InputError(recording.source, 0, "the recording lasts " + std::to_string(duration) + " s", "at least 5 s");
  }
  Evidence evidence;
  evidence.drive = drive_of(rig, recording);
  constexpr double cornered_step = 0.25e-3;  // [s]
  evidence.fine = std::max(1, static_cast<int>(std::lround(evidence.drive.period / cornered_step)));
  prepare_input(evidence, description, recording, disagree);
  evidence.at_rest = begins_at_rest(rig, evidence.drive, recording);
  std::vector<Channel> answered = response_channels(rig.kind, evidence.drive);
  if (evidence.inputs_disagree) answered.push_back(Channel::zdd_r);
  for (const Channel channel : answered) {
    if (!recording.has(channel)) continue;
    const auto c = index(channel);
    const auto& data = recording[channel];
    evidence.channels.push_back(channel);
    evidence.renewals[c] = renewals_of(data);
    evidence.noise[c] = noise_of(description, recording, channel);
    if (const auto& range = description.range[c]; range || !recording.filled.empty()) {
      std::vector<bool> clipped = recording.filled;
      clipped.resize(data.size());
      for (std::size_t k = 0; k < data.size(); ++k) clipped[k] = clipped[k] || (range && !range->holds(data[k]));
      if (std::find(clipped.begin(), clipped.end(), true) != clipped.end()) evidence.clipped[c] = std::move(clipped);
    }
  }
  if (evidence.channels.empty()) {
    throw InputError(recording.source, 0, "nothing is measured that the model could explain",
                     "one channel at least beside the input");
  }
  const std::size_t n = recording.size();
  const std::size_t split = use == Use::fitted ? n : (use == Use::held_out ? 0 : n - n / 4);
  evidence.fit = {0, split};
  evidence.judge = {split, n};
  evidence.recording = std::move(recording);
  return evidence;
}

}  // namespace host_sim::diagnose
