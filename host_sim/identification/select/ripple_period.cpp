#include "host_sim/identification/select/ripple_period.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

double ripple_period(const std::vector<double>& travel, const std::vector<double>& force) {
  const std::size_t count = std::min(travel.size(), force.size());
  if (count == 0) return 0.0;
  const auto [lowest, highest] = std::minmax_element(travel.begin(), travel.end());
  const double range = *highest - *lowest;
  if (!(range > 0.0) || !std::isfinite(range)) return 0.0;
  const std::size_t every = count / thresholds::ripple_samples + 1;
  constexpr int first = 6, last = 256;  // in steps of 1/(4X)
  std::vector<std::complex<double>> sums(last + 1);
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
  return range / (0.25 * static_cast<double>(first + (strongest - power.begin())));
}

}  // namespace host_sim::identification
