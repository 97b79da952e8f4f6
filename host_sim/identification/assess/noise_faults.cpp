#include "host_sim/identification/assess/noise_faults.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/prepare/sensor_noise.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

/// A weighted mean with the half width of its 95 % interval.
struct WeightedMean {
  double sum = 0.0, weights = 0.0;

  void add(double value, double half_width) {
    const double weight = 1.0 / std::max(half_width * half_width, 1e-12 * value * value);
    sum += weight * value;
    weights += weight;
  }
  [[nodiscard]] double value() const { return sum / weights; }
  [[nodiscard]] double half_width() const { return 1.0 / std::sqrt(weights); }
  [[nodiscard]] Interval interval() const { return {value(), value() - half_width(), value() + half_width()}; }
};

std::optional<NoiseFactor> noise_factor_of(const ProblemRecording& r, std::size_t channel) {
  const auto& declared = r.samples->declared_noise[channel];
  const ChannelNoise &prepared = r.samples->channel_noise[channel], &noise = r.noise[channel];
  // Unless what was found replaced it, the factor of the samples, which no prior limits.
  if (noise.level == prepared.level || !declared || !(*declared > 0.0)) return r.samples->noise_factor[channel];
  const double factor = noise.rms(r.samples->compared_period()) / *declared;
  return NoiseFactor{factor, 1.96 * factor * noise.relative_error};
}

std::optional<RecordingFault> level_fault(const IdentificationProblem& problem, std::size_t channel) {
  WeightedMean mean;
  for (const ProblemRecording& r : problem.recordings()) {
    if (const auto factor = noise_factor_of(r, channel)) mean.add(factor->value, factor->half_width);
  }
  if (!(mean.weights > 0.0)) return std::nullopt;
  const double off = std::abs(std::log(mean.value()));
  if (off < thresholds::noise_named || mean.value() * off < 2.0 * mean.half_width()) return std::nullopt;
  return RecordingFault{
      "noise_level", {model::channel_at(channel)}, {{"factor", mean.interval()}}, thresholds::highest_confidence};
}

/// The low-pass of one channel: nullopt where a recording has none.
struct Corner {
  Channel channel;
  int order;
  WeightedMean mean;
};
std::optional<Corner> corner_of(const IdentificationProblem& problem, std::size_t channel) {
  Corner corner{model::channel_at(channel), 0, {}};
  for (const ProblemRecording& r : problem.recordings()) {
    const ChannelNoise& noise = r.noise[channel];
    if (noise.colour.is_white() || !noise.is_known()) return std::nullopt;
    if (noise.corner_half_width > thresholds::corner_known * noise.colour.corner) return std::nullopt;
    corner.order = noise.colour.order;
    corner.mean.add(noise.colour.corner, noise.corner_half_width);
  }
  return corner;
}

bool agree(const Corner& a, const Corner& b) {
  const double difference = std::abs(a.mean.value() - b.mean.value());
  return a.order == b.order && (difference < 2.0 * std::hypot(a.mean.half_width(), b.mean.half_width()) ||
                                difference < thresholds::same_corner * b.mean.value());
}

}  // namespace

std::vector<RecordingFault> noise_faults(const IdentificationProblem& problem) {
  std::vector<RecordingFault> faults;
  std::vector<Corner> groups;
  std::vector<std::vector<Channel>> members;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (auto fault = level_fault(problem, c)) faults.push_back(std::move(*fault));
    const auto corner = corner_of(problem, c);
    if (!corner) continue;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const Corner& g) { return agree(*corner, g); });
    if (same == groups.end()) {
      groups.push_back(*corner);
      members.push_back({corner->channel});
      continue;
    }
    same->mean.add(corner->mean.value(), corner->mean.half_width());
    members[static_cast<std::size_t>(same - groups.begin())].push_back(corner->channel);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    faults.push_back(
        {"noise_colour", members[g], {{"corner_hz", groups[g].mean.interval()}}, thresholds::highest_confidence});
  }
  return faults;
}

}  // namespace host_sim::identification
