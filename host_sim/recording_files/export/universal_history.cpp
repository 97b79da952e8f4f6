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
#include "host_sim/recording_files/export/row_grid.hpp"
#include "host_sim/recording_files/export/universal_records.hpp"

namespace host_sim {
namespace {

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
  const std::optional<RowGrid> grid = find_row_grid(time);
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
