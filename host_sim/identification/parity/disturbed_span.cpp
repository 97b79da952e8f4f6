#include "host_sim/identification/parity/disturbed_span.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host_sim/identification/parity/parity_relation.hpp"
#include "host_sim/identification/parity/relation_fit.hpp"
#include "host_sim/identification/parity/thresholds.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// rms of a relation's residual, block by block; negative where samples are missing.
std::vector<double> block_sizes(const ResidualSeries& series, std::size_t samples) {
  std::vector<double> sizes;
  for (std::size_t first = 0; first + samples <= series.values.size(); first += samples) {
    double sum = 0.0;
    bool trusted = true;
    for (std::size_t k = first; k < first + samples; ++k) {
      sum += series.values[k] * series.values[k];
      trusted = trusted && (series.trusted.empty() || series.trusted[k]);
    }
    sizes.push_back(trusted ? std::sqrt(sum / static_cast<double>(samples)) : -1.0);
  }
  return sizes;
}

double median_size(std::vector<double> sizes) {
  std::erase_if(sizes, [](double size) { return size < 0.0; });
  if (sizes.empty()) return 0.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

/// Blocks that exceed the usual size so much, up to thresholds::span_gap quieter ones between them.
struct Run {
  std::size_t first = 0, last = 0;
  double sum = 0.0;  ///< of their squares, relative to the usual size
};

/// The loudest first.
template <class Counts>
std::vector<Run> loud_runs(const std::vector<double>& sizes, const Counts& counts) {
  std::vector<Run> runs;
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const double ratio = sizes[b];
    if (!counts(b) || ratio < thresholds::span_deviations) continue;
    if (runs.empty() || b - runs.back().last > thresholds::span_gap + 1) runs.push_back({b, b, 0.0});
    runs.back().last = b;
    runs.back().sum += ratio * ratio;
  }
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.sum > b.sum; });
  std::erase_if(runs, [&](const Run& run) { return run.sum < thresholds::span_share * runs.front().sum; });
  return runs;
}

}  // namespace

Balances::Balances(const firmware::RigDescription& description, const PreparedRecording& recording)
    : begin_(recording.recording.time.front()) {
  const std::vector<firmware::Recording> recordings{recording.recording};
  firmware::RigDescription known = description;
  for (std::size_t c = 0; c < recording.noise.size(); ++c) {
    if (recording.noise[c] > 0.0) known.noise[c] = recording.noise[c] * std::sqrt(static_cast<double>(recording.step));
  }
  const double period = recording.recording.sample_period;
  const double highest =
      std::min(thresholds::parity_band_edges.back(), thresholds::recorded_share_of_rate / recording.compared_period());
  const auto samples = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(thresholds::span_block / period)));
  block_ = period * static_cast<double>(samples);
  const SmoothWindow window(period);
  const std::vector<ParityRelation> relations = parity_relations(description.rig, recordings.front());
  can_be_drawn_up_ = !relations.empty();
  for (const ParityRelation& relation : relations) {
    const RelationFit fit(known, recordings, window, relation, highest);
    if (!fit.has_data()) continue;
    std::vector<double> sizes = block_sizes(fit.residual().front(), samples);
    const double usual = median_size(sizes);
    if (!(usual > 0.0)) continue;
    for (double& size : sizes) size /= usual;
    sizes_.push_back(std::move(sizes));
  }
}

std::vector<TimeSpan> Balances::disturbed(const TimeSpan& within) const {
  std::vector<Run> loudest;
  for (const std::vector<double>& sizes : sizes_) {
    std::vector<Run> runs = loud_runs(sizes, [&](std::size_t b) {
      const double from = begin_ + block_ * static_cast<double>(b);
      return from + block_ >= within.from && from <= within.to;
    });
    if (!runs.empty() && (loudest.empty() || runs.front().sum > loudest.front().sum)) loudest = std::move(runs);
  }
  std::vector<TimeSpan> spans;
  for (const Run& run : loudest) {
    spans.push_back(
        {begin_ + block_ * static_cast<double>(run.first), begin_ + block_ * static_cast<double>(run.last + 1)});
  }
  return spans;
}

}  // namespace host_sim::identification
