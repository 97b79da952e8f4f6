#include "firmware/recording/recording_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "firmware/description/input_error.hpp"
#include "firmware/description/number_text.hpp"
#include "firmware/description/quantity.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/sample_checks.hpp"

namespace firmware {
namespace {

constexpr double step_jitter = 1e-3;  // of T, as in check_time
constexpr double longest = 20e-3;     // [s] that a straight line may bridge

/// Position of the rows of a file on the equally spaced grid.
struct Grid {
  std::vector<std::size_t> place;  ///< of each row
  std::size_t late = 0;            ///< rows that `late` set back
  double lateness = 0.0;           ///< of all of them [s]
  double worst = 0.0;              ///< of one of them [s]
};

std::string milliseconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g ms", seconds * 1e3);
  return text;
}

Grid lay(const std::vector<double>& time, const std::vector<double>& late, double period,
         const RecordingLocation& file) {
  Grid grid;
  grid.place.assign(time.size(), 0);
  const double tolerance = step_jitter * period + 4.0 * std::numeric_limits<double>::epsilon() *
                                                      std::max(std::abs(time.front()), std::abs(time.back()));
  for (std::size_t k = 1; k < time.size(); ++k) {
    const double step = time[k] - time[k - 1];
    const auto explains = [&](double lateness) {
      const double periods = std::round((step - lateness) / period);
      return periods >= 1.0 && std::abs(step - lateness - periods * period) <= tolerance;
    };
    const bool even = explains(0.0);
    if (!even && !(late[k] > 0.0 && explains(late[k]))) {
      throw file.error(k, "gap in time: " + shortest(time[k]) + " follows " + shortest(time[k - 1]),
                       "whole steps of " + shortest(period) + " s plus the value in column late");
    }
    if (step > longest + 1.5 * period) {
      throw file.error(k, "a gap of " + milliseconds(step),
                       "gaps up to " + milliseconds(longest) + ", or the parts before and after as two recordings");
    }
    if (!even) {
      ++grid.late;
      grid.lateness += late[k];
      grid.worst = std::max(grid.worst, late[k]);
    }
    const double periods = std::round(step / period);
    if (static_cast<double>(grid.place[k - 1] - (k - 1)) + periods > static_cast<double>(time.size()) + 1.0) {
      throw file.error(k, "more rows are missing than were recorded", "a recording with rows in most periods");
    }
    grid.place[k] = grid.place[k - 1] + static_cast<std::size_t>(periods);
  }
  return grid;
}

/// A column on the grid; NaN where there is no sample.
std::vector<double> laid(const std::vector<double>& column, const Grid& grid) {
  std::vector<double> result(grid.place.back() + 1, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < column.size(); ++k) result[grid.place[k]] = column[k];
  return result;
}

/// Interpolates missing samples linearly; holds the previous value at the ends and if `hold` is set.
void bridge(std::vector<double>& values, bool hold, std::vector<bool>& filled, double period,
            const std::function<InputError(std::size_t, const std::string&)>& error) {
  const std::size_t n = values.size();
  for (std::size_t from = 0; from < n; ++from) {
    if (!std::isnan(values[from])) continue;
    std::size_t to = from;
    while (to < n && std::isnan(values[to])) ++to;
    if (to - from == n || static_cast<double>(to - from) * period > longest + 0.5 * period) {
      throw error(from, "nothing was measured for " + milliseconds(static_cast<double>(to - from) * period));
    }
    const double after = to < n ? values[to] : values[from - 1];
    const double before = from > 0 ? values[from - 1] : after;
    for (std::size_t k = from; k < to; ++k) {
      const double share = static_cast<double>(k - from + 1) / static_cast<double>(to - from + 1);
      values[k] = hold ? before : before + share * (after - before);
      filled[k] = true;
    }
    from = to;
  }
}

}  // namespace

void fill_gaps(Recording& recording, const std::vector<double>& late, const RecordingLocation& location,
               std::optional<double> expected_rate) {
  const std::vector<double>& time = recording.time;
  const std::size_t n = time.size();
  if (n < 2 || std::adjacent_find(time.begin(), time.end(), std::greater_equal<>()) != time.end()) return;
  const double period = expected_rate ? 1.0 / *expected_rate : median_step(time);
  const bool whole = std::none_of(recording.channels.begin(), recording.channels.end(), [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  });
  bool even = true;
  for (std::size_t k = 1; k < n; ++k) even = even && std::abs(time[k] - time[k - 1] - period) <= step_jitter * period;
  if (whole && even) return;
  if (std::abs(median_step(time) - period) > step_jitter * period) return;  // another rate: check_time() says so

  const Grid grid = lay(time, late, period, location);
  std::vector<bool> filled(grid.place.back() + 1, false);
  const auto fill = [&](std::vector<double>& column, Quantity quantity) {
    if (column.empty()) return;
    std::vector<double> values = laid(column, grid);
    bridge(values, quantity >= first_duct, filled, period, [&](std::size_t at, const std::string& wrong) {
      const auto row = std::lower_bound(grid.place.begin(), grid.place.end(), at);
      return location.error(static_cast<std::size_t>(row - grid.place.begin()),
                            std::string(quantity_name(quantity)) + ": " + wrong,
                            "samples that are missing for " + milliseconds(longest) + " at most");
    });
    column = std::move(values);
  };
  for (Quantity q = 1; q < quantity_count; ++q) fill(values(recording, q), q);
  const double begin = time.front();
  recording.time.resize(filled.size());
  for (std::size_t k = 0; k < filled.size(); ++k) recording.time[k] = begin + static_cast<double>(k) * period;
  recording.filled = std::move(filled);

  const auto missing = std::count(recording.filled.begin(), recording.filled.end(), true);
  recording.remark = one_line(recording.source) + ": ";
  if (grid.late > 0) {
    recording.remark += std::to_string(grid.late) + (grid.late == 1 ? " period" : " periods") + " of " +
                        std::to_string(n) + " began late, by " + milliseconds(grid.lateness) + " in total and " +
                        milliseconds(grid.worst) + " at most";
    if (missing == 0) return;
    recording.remark += "; ";
  }
  recording.remark +=
      std::to_string(missing) + (missing == 1 ? " row is" : " rows are") + " missing or incomplete and not used";
}

}  // namespace firmware
