#include "firmware/recording/recording_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/sample_checks.hpp"

namespace firmware {
namespace {

constexpr double step_jitter = 1e-3;    // of T, as in check_time
constexpr double longest = 20e-3;       // [s] that a straight line may bridge
constexpr double most_filled = 0.05;    // of the rows: bridged by straight lines
constexpr double most_missing = 0.10;   // of the rows: these, and those in the gaps between parts
constexpr double shortest_piece = 4.0;  // [s]

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

Grid lay(const std::vector<double>& time, const std::vector<double>& late, double period, const RecordingLocation& file,
         Missing missing, double stamp_error) {
  Grid grid;
  grid.place.assign(time.size(), 0);
  const double tolerance =
      step_jitter * period + stamp_error +
      4.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(time.front()), std::abs(time.back()));
  for (std::size_t k = 1; k < time.size(); ++k) {
    const double step = time[k] - time[k - 1];
    const auto explains = [&](double lateness) {
      const double periods = std::round((step - lateness) / period);
      return periods >= 1.0 && std::abs(step - lateness - periods * period) <= tolerance;
    };
    const bool even = explains(0.0);
    if (!even && (late.empty() || !(late[k] > 0.0 && explains(late[k])))) {
      throw file.error(
          k, "gap in time: " + shortest(time[k]) + " follows " + shortest(time[k - 1]),
          "whole steps of " + shortest(period) + " s" + (late.empty() ? "" : " plus the value in column late"));
    }
    if (missing == Missing::refuse && step > longest + 1.5 * period) {
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
void bridge(std::vector<double>& values, bool hold, std::vector<bool>& filled, double period, Missing missing,
            const std::function<InputError(std::size_t, const std::string&)>& error) {
  const std::size_t n = values.size();
  for (std::size_t from = 0; from < n; ++from) {
    if (!std::isnan(values[from])) continue;
    std::size_t to = from;
    while (to < n && std::isnan(values[to])) ++to;
    const bool is_long = static_cast<double>(to - from) * period > longest + 0.5 * period;
    if (to - from == n || (is_long && missing == Missing::refuse)) {
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

/// The row of the file that is the first incomplete one, or follows the first missing one.
std::size_t first_lost(const std::vector<bool>& filled, const Grid& grid) {
  const auto first = static_cast<std::size_t>(std::find(filled.begin(), filled.end(), true) - filled.begin());
  return static_cast<std::size_t>(std::lower_bound(grid.place.begin(), grid.place.end(), first) - grid.place.begin());
}

/// The gaps of more than 20 ms.
std::vector<Recording::Gap> long_gaps(const Recording& recording) {
  std::vector<Recording::Gap> gaps;
  const std::vector<bool>& filled = recording.filled;
  for (std::size_t k = 0; k < filled.size(); ++k) {
    std::size_t end = k;
    while (end < filled.size() && filled[end]) ++end;
    if (static_cast<double>(end - k) * recording.sample_period > longest + 0.5 * recording.sample_period) {
      gaps.push_back({recording.time[k > 0 ? k - 1 : 0], recording.time[std::min(end, filled.size() - 1)]});
    }
    k = std::max(end, k + 1) - 1;
  }
  return gaps;
}

/// InputError where more is missing than an analysis leaves out.
void check_share(const std::vector<bool>& filled, const Grid& grid, double period, const RecordingLocation& location) {
  std::size_t bridged = 0, lost = 0;
  for (std::size_t k = 0; k < filled.size();) {
    std::size_t end = k;
    while (end < filled.size() && filled[end]) ++end;
    lost += end - k;
    if (static_cast<double>(end - k) * period <= longest + 0.5 * period) bridged += end - k;
    k = std::max(end, k + 1);
  }
  const auto all = static_cast<double>(filled.size());
  if (static_cast<double>(bridged) <= most_filled * all && static_cast<double>(lost) <= most_missing * all) return;
  throw location.error(first_lost(filled, grid),
                       std::to_string(lost) + " of " + std::to_string(filled.size()) +
                           " rows are missing or incomplete, the first one here",
                       "at most 5 %, and 10 % with gaps beyond 20 ms");
}

}  // namespace

void fill_gaps(Recording& recording, const std::vector<double>& late, const RecordingLocation& location,
               std::optional<double> expected_rate, Missing missing, double stamp_error) {
  const std::vector<double>& time = recording.time;
  const std::size_t n = time.size();
  if (n < 2 || std::adjacent_find(time.begin(), time.end(), std::greater_equal<>()) != time.end()) return;
  const double period = expected_rate ? 1.0 / *expected_rate : median_step(time);
  const bool whole = std::none_of(recording.channels.begin(), recording.channels.end(), [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  });
  bool even = true;
  const double jitter = step_jitter * period + stamp_error;
  for (std::size_t k = 1; k < n; ++k) even = even && std::abs(time[k] - time[k - 1] - period) <= jitter;
  if (whole && even) return;
  if (std::abs(median_step(time) - period) > jitter) return;  // another rate: check_time() says so

  const Grid grid = lay(time, late, period, location, missing, stamp_error);
  std::vector<bool> filled(grid.place.back() + 1, false);
  const auto fill = [&](std::vector<double>& column, Quantity quantity) {
    if (column.empty()) return;
    std::vector<double> values = laid(column, grid);
    bridge(values, quantity >= first_duct, filled, period, missing, [&](std::size_t at, const std::string& wrong) {
      const auto row = std::lower_bound(grid.place.begin(), grid.place.end(), at);
      return location.error(static_cast<std::size_t>(row - grid.place.begin()),
                            std::string(quantity_name(quantity)) + ": " + wrong,
                            "samples that are missing for " + milliseconds(longest) + " at most");
    });
    column = std::move(values);
  };
  for (Quantity q = 1; q < quantity_count; ++q) fill(values(recording, q), q);
  const auto lost = std::count(filled.begin(), filled.end(), true);
  if (missing == Missing::mark) check_share(filled, grid, period, location);
  const std::size_t first_row = first_lost(filled, grid);
  const double begin = time.front();
  recording.time.resize(filled.size());
  for (std::size_t k = 0; k < filled.size(); ++k) recording.time[k] = begin + static_cast<double>(k) * period;
  recording.filled = std::move(filled);
  recording.sample_period = period;
  recording.lost_rows = static_cast<std::size_t>(lost);
  recording.gaps = long_gaps(recording);

  recording.remark = recording.remark.empty() ? one_line(recording.source) + ": " : recording.remark + "; ";
  if (grid.late > 0) {
    recording.remark += std::to_string(grid.late) + (grid.late == 1 ? " period" : " periods") + " of " +
                        std::to_string(n) + " began late, by " + milliseconds(grid.lateness) + " in total and " +
                        milliseconds(grid.worst) + " at most";
    if (lost == 0) return;
    recording.remark += "; ";
  }
  recording.remark +=
      std::to_string(lost) + (lost == 1 ? " row is" : " rows are") + " missing or incomplete and not used";
  if (missing == Missing::mark && location.first_line > 0) {
    recording.remark += ", the first at line " + std::to_string(location.first_line + first_row);
  }
}

std::vector<Recording> pieces_of(Recording recording) {
  const std::vector<bool>& filled = recording.filled;
  struct Range {
    std::size_t from, to;
  };
  std::vector<Range> parts{{0, 0}};
  const auto shortest_gap = static_cast<std::size_t>(std::lround(longest / recording.sample_period)) + 1;
  for (std::size_t k = 0; k < filled.size(); ++k) {
    std::size_t end = k;
    while (end < filled.size() && filled[end]) ++end;
    if (end - k >= shortest_gap) {
      parts.back().to = k;
      parts.push_back({end, end});
    }
    if (end > k) k = end - 1;
  }
  if (parts.size() == 1) {
    std::vector<Recording> whole;
    whole.push_back(std::move(recording));
    return whole;
  }
  parts.back().to = recording.size();
  const auto seconds = [&](const Range& part) {
    return static_cast<double>(part.to - part.from) * recording.sample_period;
  };
  const auto longest_part = std::max_element(parts.begin(), parts.end(),
                                             [&](const Range& a, const Range& b) { return seconds(a) < seconds(b); });
  const double least = std::min(shortest_piece, seconds(*longest_part));
  const std::size_t gaps = parts.size() - 1;
  std::erase_if(parts, [&](const Range& part) { return seconds(part) < least || part.from == part.to; });

  std::vector<Recording> pieces;
  double used = 0.0;
  for (const Range& part : parts) {
    Recording piece;
    piece.sample_period = recording.sample_period;
    const auto cut = [&](const auto& all) {
      using Column = std::decay_t<decltype(all)>;
      return all.empty() ? Column()
                         : Column(all.begin() + static_cast<std::ptrdiff_t>(part.from),
                                  all.begin() + static_cast<std::ptrdiff_t>(part.to));
    };
    piece.time = cut(recording.time);
    for (std::size_t c = 0; c < piece.channels.size(); ++c) piece.channels[c] = cut(recording.channels[c]);
    for (std::size_t d = 0; d < piece.ducts.size(); ++d) piece.ducts[d] = cut(recording.ducts[d]);
    piece.filled = cut(filled);
    if (std::find(piece.filled.begin(), piece.filled.end(), true) == piece.filled.end()) piece.filled.clear();
    char begin[32];
    std::snprintf(begin, sizeof begin, " from %.6g s", piece.time.front());
    piece.source = recording.source + begin;
    piece.ignored_columns = recording.ignored_columns;
    used += seconds(part);
    pieces.push_back(std::move(piece));
  }
  char text[160];
  std::snprintf(text, sizeof text, "; %zu %s beyond 20 ms, %zu %s between them used, %.4g of %.4g s", gaps,
                gaps == 1 ? "gap" : "gaps", pieces.size(), pieces.size() == 1 ? "part" : "parts", used,
                static_cast<double>(recording.size()) * recording.sample_period);
  pieces.front().remark = recording.remark + text;
  pieces.front().lost_rows = recording.lost_rows;
  pieces.front().gaps = recording.gaps;
  return pieces;
}

}  // namespace firmware
