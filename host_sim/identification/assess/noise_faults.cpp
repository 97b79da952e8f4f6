#include "host_sim/identification/assess/noise_faults.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/noise/recorder_filter.hpp"
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

}  // namespace

std::vector<RecordingFault> noise_faults(const IdentificationProblem& problem) {
  std::vector<RecordingFault> faults;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (auto fault = level_fault(problem, c)) faults.push_back(std::move(*fault));
  }
  for (RecorderFilter& filter : recorder_filters(problem, thresholds::same_corner)) {
    const Interval corner{filter.corner, filter.corner - filter.half_width, filter.corner + filter.half_width};
    faults.push_back(
        {"noise_colour", std::move(filter.channels), {{"corner_hz", corner}}, thresholds::highest_confidence});
  }
  return faults;
}

std::vector<RecordingFault> static_value_faults(const IdentificationProblem& problem) {
  std::vector<RecordingFault> faults;
  for (const ProblemRecording& r : problem.recordings()) {
    for (const StaticValue& value : r.samples->tared) {
      const bool said = std::any_of(faults.begin(), faults.end(), [&](const RecordingFault& fault) {
        return fault.channels.front() == value.channel;
      });
      if (said) continue;
      RecordingFault fault{"static_value",
                           {value.channel},
                           {{"value", {value.value, value.value, value.value}}},
                           thresholds::highest_confidence};
      fault.text = words(value);
      faults.push_back(std::move(fault));
    }
  }
  return faults;
}

std::vector<std::string> noise_remarks(const IdentificationProblem& problem) {
  std::vector<std::string> remarks;
  for (const ProblemRecording& r : problem.recordings()) {
    for (const Channel channel : problem.channels()) {
      const auto c = index(channel);
      if (r.samples->declared_noise[c]) continue;
      char text[160];
      std::snprintf(text, sizeof text, "noise of %s not given, estimated as %.3g %s rms",
                    std::string(model::name(channel)).c_str(), r.noise[c].rms(r.samples->compared_period()),
                    std::string(model::unit(channel)).c_str());
      remarks.push_back(r.samples->recording.source + ": " + text);
    }
  }
  return remarks;
}

}  // namespace host_sim::identification
