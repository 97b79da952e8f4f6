#include "host_sim/identification/learn/sliding_sides.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/identification/learn/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// A mean and its variance.
struct Mean {
  double value = 0.0, variance = 0.0;
};
Mean mean_of(const std::vector<double>& passes) {
  const auto n = static_cast<double>(passes.size());
  Mean mean;
  for (const double force : passes) mean.value += force / n;
  for (const double force : passes) mean.variance += (force - mean.value) * (force - mean.value) / (n * (n - 1.0));
  return mean;
}

}  // namespace

std::optional<SlidingSides> sliding_sides(const std::vector<double>& law, const std::vector<double>& measured,
                                          Window window, double largest) {
  std::array<std::vector<double>, 2> passes;  // of compression and rebound
  double sum = 0.0;
  std::size_t count = 0;
  int side = 0;
  const auto end_pass = [&] {
    if (side != 0 && count > 0) passes[side > 0 ? 0 : 1].push_back(sum / static_cast<double>(count));
    sum = 0.0;
    count = 0;
  };
  for (std::size_t k = window.from; k < std::min({window.to, law.size(), measured.size()}); ++k) {
    const int now = law[k] > thresholds::sliding * largest ? 1 : law[k] < -thresholds::sliding * largest ? -1 : 0;
    if (now != side) end_pass();
    side = now;
    sum += measured[k];
    ++count;
  }
  end_pass();
  if (std::min(passes[0].size(), passes[1].size()) < thresholds::fewest_passes) return std::nullopt;
  const Mean push = mean_of(passes[0]), pull = mean_of(passes[1]);
  if (!(push.value > 0.0) || !(pull.value < 0.0)) return std::nullopt;
  const double ratio = -pull.value / push.value, more = 100.0 * (ratio - 1.0);
  const double half = 196.0 * std::sqrt(pull.variance + ratio * ratio * push.variance) / push.value;
  if (std::abs(more) <= half) return std::nullopt;
  return SlidingSides{{"rebound_harder_by_per_cent", more, more - half, more + half}, 0.5 * (push.value + pull.value)};
}

}  // namespace host_sim::identification
