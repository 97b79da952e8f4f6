#include "host_sim/diagnose/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/diagnose/foot_point.hpp"
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

model::RigParameters<double> explained_part(const model::RigParameters<double>& rig) {
  if (rig.kind != RigKind::hil) return rig;
  model::RigParameters<double> part = rig;
  part.kind = RigKind::component_bench;
  part.machine.virtual_damping = 0.0;
  return part;
}

namespace {

/// Two sensors of one motion disagree beyond this: 60 000 samples of noise alone stay within 1 ± 0.03.
constexpr double most_disagreement = 1.15;

void prepare_input(Evidence& evidence, const RigDescription& description, const Recording& recording) {
  const Channel input = evidence.drive.channel;
  if (input == Channel::x_cmd) return;  // a number
  const auto noise_of = [&](Channel channel) {
    return description.noise[index(channel)].value_or(estimated_noise(recording[channel]));
  };
  evidence.input_noise.position = noise_of(input);
  if (input != Channel::z_r || !recording.has(Channel::zdd_r)) return;
  const double sz = evidence.input_noise.position, sa = noise_of(Channel::zdd_r), h = recording.sample_period;
  if (!(sz > 0.0) || !(sa > 0.0)) return;
  std::vector<double> acceleration = recording[Channel::zdd_r];
  if (const auto& range = description.range[index(Channel::zdd_r)]) {
    for (double& a : acceleration) a = range->holds(a) ? a : std::nan("");
  }
  const auto fused = fused_displacement(recording[Channel::z_r], acceleration, sz, sa, h);
  evidence.disagreement = disagreement(fused, recording[Channel::z_r], acceleration, sz, sa, h);
  if (evidence.disagreement > most_disagreement) {
    evidence.drive.motion = through_samples(recording[Channel::z_r], 1.0 / h);
    return;
  }
  evidence.drive.motion = through_samples(fused, 1.0 / h);
  evidence.input_noise.acceleration = sa;
}

}  // namespace

Evidence evidence_of(const RigDescription& description, Recording recording, Use use) {
  const model::RigParameters<double> rig = explained_part(description.rig);
  constexpr double shortest = 5.0;  // [s]: some periods of a body mode, to fit and to judge
  const double duration = recording.sample_period * static_cast<double>(recording.size());
  if (duration < shortest) {
    throw InputError(recording.source, 0, "the recording lasts " + std::to_string(duration) + " s", "at least 5 s");
  }
  Evidence evidence;
  evidence.drive = drive_of(rig, recording);
  prepare_input(evidence, description, recording);
  evidence.at_rest = begins_at_rest(rig, evidence.drive, recording);
  for (const Channel channel : response_channels(rig.kind, evidence.drive)) {
    if (!recording.has(channel)) continue;
    const auto c = index(channel);
    const auto& data = recording[channel];
    evidence.channels.push_back(channel);
    evidence.noise[c] = description.noise[c].value_or(estimated_noise(data));
    if (const auto& range = description.range[c]) {
      std::vector<bool> clipped(data.size());
      std::transform(data.begin(), data.end(), clipped.begin(), [&](double v) { return !range->holds(v); });
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
