#include "host_sim/transfer/predict/overlap.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/signal/bands.hpp"
#include "host_sim/signal/summary.hpp"

namespace host_sim::transfer {
namespace {

using model::Channel;

/// rms of the velocity by third-octave, several runs together.
std::vector<double> velocity_power(const std::vector<std::vector<double>>& runs, double rate,
                                   const std::vector<Band>& bands) {
  std::vector<double> power(bands.size());
  for (const auto& run : runs) {
    const BandRms rms = band_rms(run, rate, bands);
    for (std::size_t b = 0; b < bands.size(); ++b) {
      power[b] += std::pow(bands[b].centre * rms.rms[b], 2) / static_cast<double>(runs.size());
    }
  }
  return power;
}

}  // namespace

Overlap overlap_of(const identification::Identified& first, const SecondRig& second,
                   const model::RigParameters<double>& second_rig) {
  Overlap overlap;
  std::vector<std::vector<double>> shown, wanted;
  for (const auto& recording : first.problem.samples()) {
    for (const Channel channel : {Channel::x_act, Channel::x_cmd, Channel::dz_b}) {
      if (!recording.recording.has(channel)) continue;
      shown.push_back(recording.recording[channel]);
      break;
    }
  }
  const auto runs = second.run({second_rig});
  for (const Response& run : runs.front()) wanted.push_back(run[index(Channel::dz_b)]);
  if (shown.empty() || wanted.empty()) return overlap;
  const double first_rate = 1.0 / first.problem.samples().front().input.period;
  const double second_rate = 1.0 / second.drives.front().input.period;
  std::size_t shortest = wanted.front().size();
  for (const auto& run : wanted) shortest = std::min(shortest, run.size());
  for (const auto& run : shown) {
    shortest = std::min(shortest, static_cast<std::size_t>(static_cast<double>(run.size()) * second_rate / first_rate));
  }
  const std::vector<Band> bands = resolved_bands(shortest, std::min(first_rate, second_rate));
  const std::vector<double> a = velocity_power(shown, first_rate, bands),
                            b = velocity_power(wanted, second_rate, bands);
  double all = 0.0, covered = 0.0;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    all += b[i];
    if (a[i] < 0.01 * b[i]) continue;
    covered += b[i];
    if (overlap.lowest == 0.0) overlap.lowest = bands[i].lower;
    overlap.highest = bands[i].upper;
  }
  overlap.in_frequency = all > 0.0 ? covered / all : 1.0;
  double limit = 0.0, inside = 0.0, count = 0.0;
  for (const auto& run : shown) limit = std::max(limit, largest_magnitude(run));
  for (const auto& run : wanted) {
    for (const double v : run) inside += std::abs(v) <= limit ? 1.0 : 0.0;
    count += static_cast<double>(run.size());
  }
  overlap.in_travel = count > 0.0 ? inside / count : 1.0;
  return overlap;
}

}  // namespace host_sim::transfer
