#include "host_sim/identification/parity/fault_location.hpp"

#include <algorithm>
#include <utility>

namespace host_sim::identification {
namespace {

/// (1) for one place.
double unexplained(const std::vector<ParityResidual>& residuals, const std::string& place) {
  double left = 0.0;
  for (std::size_t b = 0; b < ParityResidual::bands; ++b) {
    double xg = 0.0, gg = 0.0, xx = 0.0;
    for (const ParityResidual& r : residuals) {
      const auto location = std::find_if(r.locations.begin(), r.locations.end(),
                                         [&](const auto& candidate) { return candidate.place == place; });
      const double gain = location == r.locations.end() ? 0.0 : location->gain[b], x = std::max(r.excess[b], 0.0);
      xg += x * gain;
      gg += gain * gain;
      xx += x * x;
    }
    left += xx - (gg > 0.0 ? xg * xg / gg : 0.0);
  }
  return left;
}

}  // namespace

std::string likely_fault_location(const std::vector<ParityResidual>& residuals) {
  double all = 0.0;
  std::vector<std::string> places;
  for (const ParityResidual& r : residuals) {
    for (const double x : r.excess) all += r.significant() ? x * x : 0.0;
    for (const auto& location : r.locations) {
      if (std::find(places.begin(), places.end(), location.place) == places.end()) places.push_back(location.place);
    }
  }
  if (!(all > 0.0)) return "";
  std::vector<std::pair<double, std::string>> ranked;
  for (const std::string& place : places) ranked.emplace_back(unexplained(residuals, place) / all, place);
  std::sort(ranked.begin(), ranked.end());
  if (ranked.empty() || ranked.front().first > thresholds::location_leaves) return "";
  std::string words;
  int count = 0;
  for (const auto& [left, place] : ranked) {
    if (left > ranked.front().first + thresholds::location_equal) break;
    words += (words.empty() ? "" : " or ") + place;
    ++count;
  }
  return count > thresholds::most_locations ? "" : words;
}

}  // namespace host_sim::identification
