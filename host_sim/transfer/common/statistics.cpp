#include "host_sim/transfer/common/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace host_sim::transfer {
namespace {

double sorted_quantile(const std::vector<double>& sorted, double p) {
  if (sorted.empty()) return 0.0;
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

double quantile(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  return sorted_quantile(values, p);
}

Bands bands_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {sorted_quantile(values, 0.5), sorted_quantile(values, 0.25), sorted_quantile(values, 0.75),
          sorted_quantile(values, 0.025), sorted_quantile(values, 0.975)};
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double variance_of(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return sum / static_cast<double>(values.size() - 1);
}

double upper_tail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

double chi_squared_tail(double x, double degrees_of_freedom) {
  if (!(x > 0.0) || !(degrees_of_freedom > 0.0)) return 1.0;
  const double v = 2.0 / (9.0 * degrees_of_freedom);
  return upper_tail((std::cbrt(x / degrees_of_freedom) - 1.0 + v) / std::sqrt(v));
}

double tail_probability(double x, const std::vector<double>& draws) {
  const double mean = mean_of(draws), variance = variance_of(draws);
  if (!(mean > 0.0) || !(variance > 0.0)) return x <= mean ? 1.0 : 0.0;
  const double scale = variance / (2.0 * mean);
  return chi_squared_tail(x / scale, mean / scale);
}

}  // namespace host_sim::transfer
