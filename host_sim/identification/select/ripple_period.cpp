#include "host_sim/identification/select/ripple_period.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

namespace {

/// (3): the most periods in a range that samples, each `every`-th, tell from fewer.
double most_periods(const std::vector<double>& travel, std::size_t count, std::size_t every, double range) {
  std::vector<double> steps;
  for (std::size_t k = every; k < count; k += every) steps.push_back(std::abs(travel[k] - travel[k - every]));
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + std::ssize(steps) / 2;
  std::nth_element(steps.begin(), middle, steps.end());
  return std::min(thresholds::most_ripples, 0.5 * range / std::max(*middle, 1e-9 * range));
}

}  // namespace

double ripple_period(const std::vector<double>& travel, const std::vector<double>& force) {
  const std::size_t count = std::min(travel.size(), force.size());
  if (count == 0) return 0.0;
  const auto [lowest, highest] = std::minmax_element(travel.begin(), travel.end());
  const double range = *highest - *lowest;
  if (!(range > 0.0) || !std::isfinite(range)) return 0.0;
  const std::size_t every = count / thresholds::ripple_samples + 1;
  constexpr int first = 6;  // in steps of 1/(4X), as last is
  const int last = static_cast<int>(4.0 * most_periods(travel, count, every, range));
  if (last < first) return 0.0;
  std::vector<std::complex<double>> sums(static_cast<std::size_t>(last) + 1);
  double mean = 0.0;
  std::size_t taken = 0;
  for (std::size_t k = 0; k < count; k += every) mean += force[k], ++taken;
  mean /= static_cast<double>(taken);
  for (std::size_t k = 0; k < count; k += every) {
    const double left = force[k] - mean;
    if (!std::isfinite(left)) continue;
    const auto one_step = std::polar(1.0, 2.0 * std::numbers::pi * 0.25 * (travel[k] - *lowest) / range);
    std::complex<double> turn = left;
    for (int i = 1; i <= last; ++i) sums[static_cast<std::size_t>(i)] += turn *= one_step;
  }
  std::vector<double> power;
  for (int i = first; i <= last; ++i) power.push_back(std::norm(sums[static_cast<std::size_t>(i)]));
  const auto strongest = std::max_element(power.begin(), power.end());
  std::vector<double> sorted = power;
  std::nth_element(sorted.begin(), sorted.begin() + std::ssize(sorted) / 2, sorted.end());
  if (!(*strongest > thresholds::ripple_prominence * sorted[sorted.size() / 2])) return 0.0;
  // Between the steps, so that the phase is right to an eighth of a turn at both ends.
  const double step = 0.25 * static_cast<double>(first + (strongest - power.begin()));
  double best = step, largest = 0.0;
  for (int i = -8; i <= 8; ++i) {
    const double periods = step + static_cast<double>(i) / 32.0;
    std::complex<double> sum = 0.0;
    for (std::size_t k = 0; k < count; k += every) {
      if (!std::isfinite(force[k])) continue;
      sum += (force[k] - mean) * std::polar(1.0, 2.0 * std::numbers::pi * periods * (travel[k] - *lowest) / range);
    }
    if (std::norm(sum) > largest) {
      largest = std::norm(sum);
      best = periods;
    }
  }
  return range / best;
}

}  // namespace host_sim::identification
