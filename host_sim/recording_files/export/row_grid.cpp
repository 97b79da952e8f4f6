#include "host_sim/recording_files/export/row_grid.hpp"

#include <algorithm>
#include <cmath>

namespace host_sim {
namespace {

// Part of a period by which stamps may be off and still lie on the grid: what the readers allow for jitter.
constexpr double grid_tolerance = 1e-3;

std::optional<RowGrid> grid_of(const std::vector<double>& time, double period) {
  RowGrid grid{period, {}};
  for (const double t : time) {
    const double row = std::round((t - time.front()) / period);
    const bool rises = grid.rows.empty() || row > static_cast<double>(grid.rows.back());
    // A recording of which half is missing is no grid with holes.
    if (!rises || !(row < 2.0 * static_cast<double>(time.size()))) return std::nullopt;
    if (std::abs(t - time.front() - row * period) > grid_tolerance * period) return std::nullopt;
    grid.rows.push_back(static_cast<std::size_t>(row));
  }
  return grid;
}

// The period of most steps: with missing rows the mean step is longer.
double usual_step_of(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < time.size(); ++k) steps.push_back(time[k] - time[k - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

std::optional<RowGrid> find_row_grid(const std::vector<double>& time) {
  if (time.size() < 2) return RowGrid{0.0, std::vector<std::size_t>(time.size(), 0)};
  const double mean = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  const std::optional<RowGrid> grid = grid_of(time, mean);
  return grid ? grid : grid_of(time, usual_step_of(time));
}

}  // namespace host_sim
