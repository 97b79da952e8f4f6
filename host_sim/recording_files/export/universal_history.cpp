#include "host_sim/recording_files/export/universal_history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/quantity.hpp"
#include "host_sim/recording_files/export/columns.hpp"
#include "host_sim/recording_files/export/universal_records.hpp"

namespace host_sim {
namespace {

// Part of a period by which stamps may be off and still lie on the grid: what the readers allow for jitter.
constexpr double grid_tolerance = 1e-3;

// Equally spaced rows, of which some may be missing.
struct Grid {
  double period;
  std::vector<std::size_t> rows;  // of each sample
};

std::optional<Grid> grid_of(const std::vector<double>& time, double period) {
  Grid grid{period, {}};
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
double median_step(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < time.size(); ++k) steps.push_back(time[k] - time[k - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

std::optional<Grid> find_grid(const std::vector<double>& time) {
  if (time.size() < 2) return Grid{0.0, std::vector<std::size_t>(time.size(), 0)};
  const double mean = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  const std::optional<Grid> grid = grid_of(time, mean);
  return grid ? grid : grid_of(time, median_step(time));
}

// E13.5 rounds a time by half a unit of its sixth digit; two of them must not move a step by a tenth.
void demand_distinct(const std::vector<double>& time, std::string_view file) {
  for (std::size_t k = 1; k < time.size(); ++k) {
    const double largest = std::max(std::abs(time[k]), std::abs(time[k - 1]));
    const double digit = std::pow(10.0, std::floor(std::log10(std::max(largest, 1e-300))) - 5.0);
    if (digit <= 0.1 * (time[k] - time[k - 1])) continue;
    throw firmware::OutputError(std::string(file),
                                "a universal file has six digits for unevenly spaced times, too few at t = " +
                                    firmware::shortest(time[k]) + " s",
                                "a recording without missing rows, or another format");
  }
}

universal::Function function_of(const ExportColumn& column) {
  universal::Function f;
  f.type = universal::FunctionType::time_response;
  f.id[0] = column.name;
  f.id[1] = "rigtwin, time history";
  f.response = column.name;
  f.abscissa = universal::time_axis;
  f.ordinate = universal::axis_for(column.unit, column.name);
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel channel = model::channel_at(c);
    if (column.name == model::name(channel)) f.response_node = universal::node_of(channel);
  }
  return f;
}

}  // namespace

void format_universal(const firmware::Recording& recording, std::string_view file,
                      const std::function<void(std::string_view)>& take) {
  const std::vector<double>& time = recording.time;
  const std::optional<Grid> grid = find_grid(time);
  if (!grid) demand_distinct(time, file);
  take(universal::units_dataset());
  int number = 0;
  for (const ExportColumn& column : columns_to_export(recording)) {
    if (column.values == &time) continue;
    universal::Function f = function_of(column);
    f.number = ++number;
    f.even = grid.has_value();
    if (grid && !time.empty()) {
      f.first = time.front();
      f.increment = grid->period;
    }
    f.points = !grid ? time.size() : time.empty() ? 0 : grid->rows.back() + 1;
    take(universal::function_header(f));
    std::vector<double> numbers;
    const auto put = [&](double value, bool last) {
      constexpr std::size_t block = 4096;  // a multiple of the four numbers of a line
      numbers.push_back(value);
      if (numbers.size() < block && !last) return;
      take(universal::function_numbers(numbers, f.even));
      numbers.clear();
    };
    std::size_t row = 0;
    for (std::size_t k = 0; k < time.size(); ++k, ++row) {
      for (; grid && row < grid->rows[k]; ++row) put(std::numeric_limits<double>::quiet_NaN(), false);
      if (!grid) put(time[k], false);
      put((*column.values)[k], k + 1 == time.size());
    }
    take(universal::dataset_end());
  }
}

}  // namespace host_sim
