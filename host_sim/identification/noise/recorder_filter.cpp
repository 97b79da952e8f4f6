#include "host_sim/identification/noise/recorder_filter.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// A weighted mean with the half width of its 95 % interval.
struct WeightedCorner {
  double sum = 0.0, weights = 0.0;

  void add(double value, double half_width) {
    const double weight = 1.0 / std::max(half_width * half_width, 1e-12 * value * value);
    sum += weight * value;
    weights += weight;
  }
  [[nodiscard]] double value() const { return sum / weights; }
  [[nodiscard]] double half_width() const { return 1.0 / std::sqrt(weights); }
};

/// The low-pass of one channel: nullopt where a recording has none.
std::optional<RecorderFilter> filter_of(const IdentificationProblem& problem, std::size_t channel) {
  RecorderFilter filter{{model::channel_at(channel)}, 0};
  WeightedCorner mean;
  for (const ProblemRecording& r : problem.recordings()) {
    const ChannelNoise& noise = r.noise[channel];
    const bool fused = r.samples->inputs_fused && filter.channels.front() == model::Channel::zdd_r;
    const bool is_used =
        fused || r.samples->explains(filter.channels.front()) || r.samples->input.channel == filter.channels.front();
    if (!is_used || !noise.shows_a_filter()) return std::nullopt;
    filter.order = noise.colour.order;
    filter.digital = noise.colour.filter == NoiseColour::Filter::digital;
    mean.add(noise.colour.corner, noise.corner_half_width);
  }
  filter.corner = mean.value();
  filter.half_width = mean.half_width();
  return filter;
}

bool agree(const RecorderFilter& a, const RecorderFilter& b, double alike) {
  const double difference = std::abs(a.corner - b.corner);
  return a.order == b.order && a.digital == b.digital &&
         (difference < 2.0 * std::hypot(a.half_width, b.half_width) || difference < alike * b.corner);
}

}  // namespace

std::vector<RecorderFilter> recorder_filters(const IdentificationProblem& problem, double alike) {
  std::vector<RecorderFilter> groups;
  std::vector<WeightedCorner> means;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel channel = model::channel_at(c);
    if (channel == model::Channel::x_cmd || channel == model::Channel::z_cmd) continue;  // computed, as commanded
    const auto own = filter_of(problem, c);
    if (!own) continue;
    const auto same = std::find_if(groups.begin(), groups.end(),
                                   [&](const RecorderFilter& group) { return agree(*own, group, alike); });
    const auto at = static_cast<std::size_t>(same - groups.begin());
    if (same == groups.end()) {
      groups.push_back(*own);
      means.emplace_back();
    } else {
      same->channels.push_back(own->channels.front());
    }
    means[at].add(own->corner, own->half_width);
    groups[at].corner = means[at].value();
    groups[at].half_width = means[at].half_width();
  }
  return groups;
}

bool shows_its_colour(const IdentificationProblem& problem, model::Channel channel) {
  return std::all_of(problem.recordings().begin(), problem.recordings().end(), [channel](const ProblemRecording& r) {
    const ChannelNoise& noise = r.noise[index(channel)];
    return noise.shows_a_filter() || (noise.is_known() && noise.colour.is_white());
  });
}

}  // namespace host_sim::identification
