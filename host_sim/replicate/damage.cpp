#include "host_sim/replicate/damage.hpp"

#include <algorithm>
#include <cmath>

namespace host_sim::replicate {

std::vector<double> turning_points(std::span<const double> signal) {
  std::vector<double> points;
  for (const double value : signal) {
    if (!points.empty() && value == points.back()) continue;
    const std::size_t n = points.size();
    const bool goes_on = n >= 2 && (points[n - 1] > points[n - 2]) == (value > points[n - 1]);
    if (goes_on) {
      points.back() = value;
    } else {
      points.push_back(value);
    }
  }
  return points;
}

std::vector<Cycle> rainflow(std::span<const double> signal) {
  std::vector<Cycle> cycles;
  std::vector<double> open;
  for (const double point : turning_points(signal)) {
    open.push_back(point);
    while (open.size() >= 4) {
      const double* const p = open.data() + open.size() - 4;
      const double inner = std::abs(p[2] - p[1]);
      if (inner > std::abs(p[1] - p[0]) || inner > std::abs(p[3] - p[2])) break;
      cycles.push_back({p[1], p[2], 1.0});
      open.erase(open.end() - 3, open.end() - 1);
    }
  }
  for (std::size_t i = 1; i < open.size(); ++i) cycles.push_back({open[i - 1], open[i], 0.5});
  return cycles;
}

double pseudo_damage(const std::vector<Cycle>& cycles, double exponent) {
  double sum = 0.0;
  for (const Cycle& cycle : cycles) sum += cycle.count * std::pow(cycle.range(), exponent);
  return sum;
}

RainflowMatrix rainflow_matrix(const std::vector<Cycle>& cycles, double lowest, double highest, std::size_t classes) {
  RainflowMatrix matrix{lowest, highest, classes, std::vector<double>(classes * classes, 0.0)};
  const double width = (highest - lowest) / static_cast<double>(classes);
  const auto of = [&](double value) {
    const double place = std::clamp((value - lowest) / width, 0.0, static_cast<double>(classes - 1));
    return static_cast<std::size_t>(place);
  };
  if (!(width > 0.0)) return matrix;
  for (const Cycle& cycle : cycles) matrix.counts[of(cycle.from) * classes + of(cycle.to)] += cycle.count;
  return matrix;
}

std::vector<double> level_crossings(std::span<const double> signal, const std::vector<double>& levels) {
  std::vector<double> counts;
  for (const double level : levels) {
    double count = 0.0;
    for (std::size_t k = 1; k < signal.size(); ++k) {
      if (signal[k - 1] < level && signal[k] >= level) count += 1.0;
    }
    counts.push_back(count);
  }
  return counts;
}

}  // namespace host_sim::replicate
