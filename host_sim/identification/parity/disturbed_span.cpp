#include "host_sim/identification/parity/disturbed_span.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host_sim/identification/parity/parity_relation.hpp"
#include "host_sim/identification/parity/relation_fit.hpp"
#include "host_sim/identification/parity/thresholds.hpp"

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

}  // namespace

std::optional<TimeSpan> disturbed_span(const firmware::RigDescription& description, const PreparedRecording& recording,
                                       const TimeSpan& within) {
  const std::vector<firmware::Recording> recordings{recording.recording};
  firmware::RigDescription known = description;
  for (std::size_t c = 0; c < recording.noise.size(); ++c) {
    if (recording.noise[c] > 0.0) known.noise[c] = recording.noise[c] * std::sqrt(static_cast<double>(recording.step));
  }
  const double period = recording.recording.sample_period, begin = recording.recording.time.front();
  const double highest =
      std::min(thresholds::parity_band_edges.back(), thresholds::recorded_share_of_rate / recording.compared_period());
  const auto samples = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(thresholds::span_block / period)));
  const double block = period * static_cast<double>(samples);
  const SmoothWindow window(period);
  std::optional<TimeSpan> span;
  double strongest = thresholds::span_deviations;
  for (const ParityRelation& relation : parity_relations(description.rig, recordings.front())) {
    const RelationFit fit(known, recordings, window, relation, highest);
    if (!fit.has_data()) continue;
    const std::vector<double> sizes = block_sizes(fit.residual().front(), samples);
    const double usual = median_size(sizes);
    if (!(usual > 0.0)) continue;
    double peak = 0.0;
    TimeSpan found{0.0, 0.0};
    bool begun = false;
    for (std::size_t b = 0; b < sizes.size(); ++b) {
      const double from = begin + block * static_cast<double>(b);
      if (from + block < within.from || from > within.to) continue;
      const double ratio = sizes[b] / usual;
      peak = std::max(peak, ratio);
      if (ratio < thresholds::span_deviations) continue;
      if (!begun) found.from = from;
      begun = true;
      found.to = from + block;
    }
    if (peak <= strongest) continue;
    strongest = peak;
    span = found;
  }
  return span;
}

}  // namespace host_sim::identification
