#include "host_sim/recording_files/tables/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "firmware/description/text/number_text.hpp"
#include "firmware/recording/sample_checks.hpp"

namespace host_sim {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// A step beyond this many medians is a gap: halfway between one period with 60 % of jitter and two periods.
constexpr double gap_in_steps = 1.6;
// Jitter up to this share of a step is none: it is what check_time() allows.
constexpr double even_share = 1e-3;

bool rises_everywhere(const std::vector<double>& time) {
  return time.size() > 1 && std::adjacent_find(time.begin(), time.end(), std::greater_equal<>()) == time.end();
}

double rounded_rate(double period) { return std::round(1e3 / period) / 1e3; }

// Index of the last time not after t, beginning the search at `from`; the time axis begins at or before t.
std::size_t last_not_after(const std::vector<double>& time, double t, std::size_t from) {
  while (from + 1 < time.size() && time[from + 1] <= t) ++from;
  return from;
}

}  // namespace

std::optional<EvenGrid> even_grid(const std::vector<double>& time, std::optional<double> rate) {
  if (!rises_everywhere(time)) return std::nullopt;
  const double median = firmware::median_step(time);
  EvenGrid grid{{}, 0.0, INFINITY, 0.0, 0};
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 1; k < time.size(); ++k) {
    const double step = time[k] - time[k - 1];
    if (step > gap_in_steps * median) {
      ++grid.gaps;
      continue;
    }
    grid.shortest_step = std::min(grid.shortest_step, step);
    grid.longest_step = std::max(grid.longest_step, step);
    sum += step;
    ++count;
  }
  grid.period = sum / static_cast<double>(count);
  if (rate && std::abs(grid.period * *rate - 1.0) < 0.01) grid.period = 1.0 / *rate;
  const double resolution = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(time.back());
  const double uneven = std::max(grid.longest_step - grid.period, grid.period - grid.shortest_step);
  if (uneven <= even_share * grid.period + resolution) return std::nullopt;

  const auto steps = static_cast<std::size_t>(std::floor((time.back() - time.front()) / grid.period + 1e-9));
  if (steps > 4 * time.size()) return std::nullopt;  // mostly gaps: for the reader to refuse
  std::size_t before = 0;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double t = time.front() + static_cast<double>(k) * grid.period;
    before = last_not_after(time, t, before);
    const bool in_gap =
        before + 1 < time.size() && time[before] < t && time[before + 1] - time[before] > gap_in_steps * median;
    if (!in_gap) grid.time.push_back(t);
  }
  if (grid.time.size() < 2) return std::nullopt;
  return grid;
}

Resampled resample(const std::vector<double>& time, const std::vector<double>& values,
                   const std::vector<double>& axis) {
  Resampled result;
  result.values.assign(axis.size(), not_a_number);
  if (time.size() < 2 || axis.size() < 2 || values.size() != time.size()) return result;
  const double median = firmware::median_step(time);
  const double wanted = firmware::median_step(axis);
  const bool faster = median < 0.6 * wanted;
  std::size_t before = 0;
  for (std::size_t k = 0; k < axis.size(); ++k) {
    const double t = axis[k];
    const double slack = 1e-6 * median;  // of stamps that are rounded
    if (t < time.front() - slack || t > time.back() + slack) continue;
    before = last_not_after(time, std::max(t, time.front()), before);
    if (faster) {
      double sum = 0.0;
      double weights = 0.0;
      std::size_t i = before;
      while (i > 0 && time[i - 1] > t - 0.5 * wanted - median) --i;
      for (; i < time.size() && time[i] < t + 0.5 * wanted + median; ++i) {
        // 1 inside, falling to 0 over one of the faster steps around the ends of the period.
        const double inside = (0.5 * wanted - std::abs(time[i] - t)) / median + 0.5;
        const double weight = std::clamp(inside, 0.0, 1.0);
        if (weight == 0.0) continue;
        sum += weight * values[i];
        weights += weight;
      }
      result.values[k] = sum / weights;
      continue;
    }
    const std::size_t after = std::min(before + 1, time.size() - 1);
    const double step = time[after] - time[before];
    const double share = step > 0.0 ? std::clamp((t - time[before]) / step, 0.0, 1.0) : 0.0;
    if (share <= 1e-9) {
      result.values[k] = values[before];
    } else if (share >= 1.0 - 1e-9) {
      result.values[k] = values[after];
    } else if (step <= gap_in_steps * median) {
      result.values[k] = values[before] + share * (values[after] - values[before]);
    }
  }
  const std::string from = firmware::shortest(rounded_rate(median)) + " Hz";
  const std::string to = firmware::shortest(rounded_rate(wanted)) + " Hz";
  if (faster) result.how = from + ", averaged over each period of " + to;
  if (median > 1.001 * wanted) result.how = from + ", interpolated linearly to " + to;
  return result;
}

}  // namespace host_sim
