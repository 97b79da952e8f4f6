#include "host_sim/recording_files/tables/table_recording.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/sample_checks.hpp"
#include "host_sim/recording_files/tables/resampling.hpp"

namespace host_sim {
namespace {

using firmware::in_quotes;
using firmware::InputError;
using firmware::shortest;

std::size_t line_of(const RawTable& table, std::size_t row) { return row < table.lines.size() ? table.lines[row] : 0; }

std::vector<double> scaled(std::vector<double> values, double scale, double offset) {
  if (scale == 1.0 && offset == 0.0) return values;
  for (double& value : values) value = scale * value + offset;
  return values;
}

class Builder {
 public:
  Builder(RawTable& table, const Interpretation& meaning, const RigContext& rig, bool keep_others)
      : table_(table), meaning_(meaning), rig_(rig), keep_others_(keep_others) {}

  TableRecording run() {
    firmware::Recording& recording = result_.recording;
    recording.source = table_.source;
    recording.time = shared_axis();
    choose_axis();
    cut_to_slow_channels();
    shared_is_axis_ = shared_ == recording.time;
    for (const ColumnMeaning& channel : meaning_.channels) {
      values(recording, channel.quantity) =
          scaled(on_axis(table_.columns[channel.column]), channel.scale, channel.offset);
    }
    for (std::size_t c = 0; c < table_.columns.size(); ++c) take_other(c);
    check_ducts();
    if (recording.size() < 2) {
      throw InputError(table_.source, line_of(table_, 0), "there is only one sample", "at least two");
    }
    firmware::check_time_rises(recording, {table_.source, 0});
    return std::move(result_);
  }

 private:
  // The time of the rows that the columns share; rows without a time stamp are left out.
  std::vector<double> shared_axis() {
    std::vector<double> time(table_.rows);
    const TimeMeaning& axis = meaning_.time;
    if (table_.rows == 0) return time;
    if (!axis.column) return firmware::sample_times(table_.rows, axis.rate);
    const std::vector<double>& stamps = table_.columns[*axis.column].values;
    const bool clock = table_.columns[*axis.column].is_clock;
    for (std::size_t k = 0; k < table_.rows; ++k) {
      const double since_first = stamps[k] - stamps.front();
      // Differences of clock times are whole nanoseconds; the subtraction left 10⁻¹¹ s of dirt.
      time[k] = axis.counts ? since_first / axis.rate
                : clock     ? std::round(1e9 * since_first) / 1e9
                            : firmware::Target::in_seconds(stamps[k], axis.scale) + axis.offset;
    }
    lay_on_grid(time);
    for (std::size_t k = 1; k < time.size(); ++k) {
      if (time[k] > time[k - 1]) continue;
      const bool falls = time[k] < time[k - 1];
      if (std::isnan(time[k]) || std::isnan(time[k - 1])) break;
      const std::string stamp = shortest(time[k]) + " s follows " + shortest(time[k - 1]) + " s";
      throw InputError(table_.source, line_of(table_, k),
                       (falls ? "time runs backwards: " : "time does not increase: ") + stamp,
                       "a later time in each sample");
    }
    for (std::size_t k = 0; k < time.size(); ++k) {
      if (std::isfinite(time[k])) continue;
      throw InputError(table_.source, line_of(table_, k), "the time is missing in row " + std::to_string(k + 1),
                       "a time stamp in each row");
    }
    return time;
  }

  // Stamps that repeat because they are coarser than the period (whole milliseconds at 1024 Hz): every row is one
  // period after the row before it, if all stamps are within their rounding of that grid.
  void lay_on_grid(std::vector<double>& time) {
    bool repeats = false;
    for (std::size_t k = 1; k < time.size(); ++k) {
      if (!(time[k] >= time[k - 1])) return;
      repeats = repeats || time[k] == time[k - 1];
    }
    if (!repeats || time.size() < 10) return;
    double middle_k = 0.5 * static_cast<double>(time.size() - 1), middle_t = 0.0, kk = 0.0, kt = 0.0;
    for (const double t : time) middle_t += (t - time.front()) / static_cast<double>(time.size());
    for (std::size_t k = 0; k < time.size(); ++k) {
      const double from_middle = static_cast<double>(k) - middle_k;
      kk += from_middle * from_middle;
      kt += from_middle * (time[k] - time.front() - middle_t);
    }
    double period = kt / kk;
    // A whole rate within what the rounding leaves open of it.
    const firmware::StampRounding rounding = stamps();
    const double place = rounding.scale * std::pow(10.0, -rounding.decimals);
    const double doubt = place / (period * static_cast<double>(time.size()));
    if (const double whole = std::round(1.0 / period); std::abs(period * whole - 1.0) < doubt) period = 1.0 / whole;
    const double begin = time.front() + middle_t - period * middle_k;
    double worst = 0.0;
    for (std::size_t k = 0; k < time.size(); ++k)
      worst = std::max(worst, std::abs(time[k] - begin - static_cast<double>(k) * period));
    if (!(worst <= place * (1.0 + 1e-6))) return;
    const double start = std::abs(begin - time.front()) <= place ? time.front() : begin;
    const std::vector<double> grid = firmware::sample_times(time.size(), 1.0 / period);
    for (std::size_t k = 0; k < time.size(); ++k) time[k] = start + grid[k];
    result_.notes.push_back("the times are rounded to " + shortest(std::round(1e9 * place) / 1e6) +
                            " ms and repeat; the rows lie on a grid of " + shortest(std::round(1e3 / period) / 1e3) +
                            " Hz");
  }

  // Before its first and behind its last filled cell a slow channel says nothing.
  void cut_to_slow_channels() {
    std::vector<double>& axis = result_.recording.time;
    double begin = -INFINITY;
    double end = INFINITY;
    for (const ColumnMeaning& channel : meaning_.channels) {
      const RawColumn& column = table_.columns[channel.column];
      if (!column.is_slow || !column.own_time.empty()) continue;
      const auto [time, values] = filled_cells(column);
      if (time.size() < 2) continue;
      begin = std::max(begin, time.front());
      end = std::min(end, time.back());
    }
    const std::size_t before = axis.size();
    std::erase_if(axis, [&](double t) { return t < begin || t > end; });
    if (axis.size() == before) return;
    result_.notes.push_back(std::to_string(before - axis.size()) +
                            " rows before the first or behind the last value of a slow channel are left out");
    if (axis.size() < 2) throw InputError(table_.source, 0, "the columns have no common time", "columns that overlap");
  }

  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> filled_cells(const RawColumn& column) const {
    std::pair<std::vector<double>, std::vector<double>> cells;
    for (std::size_t k = 0; k < std::min(column.values.size(), shared_.size()); ++k) {
      if (std::isnan(column.values[k])) continue;
      cells.first.push_back(shared_[k]);
      cells.second.push_back(column.values[k]);
    }
    return cells;
  }

  // With several rates the recording's axis is one of theirs.
  void choose_axis() {
    const std::vector<double>* best = nullptr;
    const auto period = [](const std::vector<double>& time) {
      return time.size() < 2 ? INFINITY : (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    };
    const auto is_the_rigs = [&](const std::vector<double>& time) {
      return rig_.rate && std::abs(period(time) * *rig_.rate - 1.0) < 1e-3;
    };
    const auto consider = [&](const std::vector<double>& time) {
      if (time.size() < 2) return;
      if (best == nullptr || (is_the_rigs(time) && !is_the_rigs(*best)) ||
          (!is_the_rigs(*best) && period(time) < period(*best) * (1.0 - 1e-9))) {
        best = &time;
      }
    };
    std::vector<double>& axis = result_.recording.time;
    const std::vector<double> shared = axis;
    bool several = false;
    // A single guess does not set the rate of the other columns.
    if (meaning_.channels.size() == 1 && !meaning_.channels.front().reason.empty() && keep_others_) {
      for (const RawColumn& column : table_.columns) {
        if (!column.own_time.empty() && strictly_rises(column.own_time)) consider(column.own_time);
      }
    }
    for (const ColumnMeaning& channel : meaning_.channels) {
      const std::vector<double>& own = table_.columns[channel.column].own_time;
      several = several || !own.empty();
      consider(own.empty() ? shared : own);
    }
    if (!several || best == nullptr) {
      shared_ = axis;
      even_out();
      return;
    }
    // Only the span that every channel covers.
    double begin = -INFINITY;
    double end = INFINITY;
    for (const ColumnMeaning& channel : meaning_.channels) {
      const std::vector<double>& own = table_.columns[channel.column].own_time;
      const std::vector<double>& time = own.empty() ? shared : own;
      if (time.size() < 2) {
        throw InputError(table_.source, 0, in_quotes(table_.columns[channel.column].name) + " has no time stamps",
                         "at least two");
      }
      for (std::size_t k = 1; k < time.size(); ++k) {
        if (time[k] > time[k - 1]) continue;
        throw InputError(table_.source, 0,
                         "the time of " + in_quotes(table_.columns[channel.column].name) +
                             " does not increase: " + shortest(time[k]) + " follows " + shortest(time[k - 1]),
                         "a later time in each sample");
      }
      begin = std::max(begin, time.front());
      end = std::min(end, time.back());
    }
    std::vector<double> kept;
    for (const double t : *best) {
      if (t >= begin && t <= end) kept.push_back(t);
    }
    if (kept.size() < 2) throw InputError(table_.source, 0, "the columns have no common time", "columns that overlap");
    if (const std::size_t lost = best->size() - kept.size(); lost > 0) {
      result_.notes.push_back(std::to_string(lost) + " of " + std::to_string(best->size()) +
                              " samples outside the time that all channels cover are left out");
    }
    shared_ = shared;
    axis = std::move(kept);
  }

  // Uneven steps become an even grid.
  void even_out() {
    std::vector<double>& axis = result_.recording.time;
    if (axis.size() < 3 || !meaning_.time.column) return;
    const std::optional<EvenGrid> grid = even_grid(axis, rig_.rate);
    if (!grid) return;
    firmware::StampRounding rounding = stamps();
    firmware::Recording trial;
    trial.source = table_.source;
    trial.time = axis;
    if (firmware::recover_grid(trial, rounding, rig_.rate)) return;  // an even grid, rounded: left to the reader
    result_.notes.push_back(
        "the steps in time are uneven (" + shortest(std::round(1e6 * grid->shortest_step) / 1e3) + " … " +
        shortest(std::round(1e6 * grid->longest_step) / 1e3) + " ms): interpolated linearly onto a grid of " +
        shortest(std::round(1e3 / grid->period) / 1e3) + " Hz" +
        (grid->gaps == 0 ? std::string()
                         : ", " + std::to_string(grid->gaps) + (grid->gaps == 1 ? " gap is kept" : " gaps are kept")));
    axis = grid->time;
  }

  std::vector<double> on_axis(RawColumn& column) {
    const std::vector<double>& axis = result_.recording.time;
    const std::vector<double>& own = column.own_time.empty() ? shared_ : column.own_time;
    if (column.is_slow && column.own_time.empty()) {
      const auto [time, values] = filled_cells(column);
      const Resampled resampled = resample(time, values, axis);
      result_.notes.push_back(in_quotes(column.name) + " has " + std::to_string(time.size()) + " values in " +
                              std::to_string(shared_.size()) + " rows" +
                              (resampled.how.empty() ? "" : ": " + resampled.how));
      return resampled.values;
    }
    if (column.own_time.empty() ? shared_is_axis_ : own == axis) return std::move(column.values);
    const Resampled resampled = resample(own, column.values, axis);
    if (!column.own_time.empty() && !resampled.how.empty()) {
      result_.notes.push_back(in_quotes(column.name) + ": " + resampled.how);
    }
    return resampled.values;
  }

  void take_other(std::size_t c) {
    RawColumn& column = table_.columns[c];
    const bool is_time = meaning_.time.column == c;
    const bool is_channel = std::any_of(meaning_.channels.begin(), meaning_.channels.end(),
                                        [&](const ColumnMeaning& channel) { return channel.column == c; });
    if (is_time || is_channel) return;
    result_.recording.ignored_columns.push_back(column.text);
    if (!keep_others_) return;
    const auto leave_out = [&](std::string why) {
      result_.left_out.push_back({unique_name(table_, c), std::move(why)});
    };
    const bool also_time = std::find(meaning_.times.begin(), meaning_.times.end(), c) != meaning_.times.end();
    if (also_time) return leave_out("a time");
    if (column.is_clock) return leave_out("a clock");
    if (std::none_of(column.values.begin(), column.values.end(), [](double v) { return !std::isnan(v); }))
      return leave_out(column.values.empty() ? "text" : "no numbers");
    if (column.own_time.empty() && column.values.size() != shared_.size())
      return leave_out(std::to_string(column.values.size()) + " values, the time has " +
                       std::to_string(shared_.size()));
    if (!column.own_time.empty() && !strictly_rises(column.own_time)) return leave_out("its time does not increase");
    const std::optional<firmware::Unit> unit = firmware::find_unit(column.unit);
    std::string name;
    for (const char ch : unique_name(table_, c) == column.text ? column.name : unique_name(table_, c))
      name += ch == ',' || ch == '"' || static_cast<unsigned char>(ch) < 0x20 ? '_' : ch;
    // A name that a reader takes for a channel is one only where the channel is this column.
    if (name.empty() || firmware::find_quantity(name) || name == "late" || name == "mode") name += "_raw";
    const bool known = unit && unit->dimension != firmware::Dimension::none;
    result_.recording.extra.push_back({name, known ? std::string(firmware::si_unit(unit->dimension)) : column.unit,
                                       scaled(on_axis(column), known ? unit->scale : 1.0, 0.0)});
  }

  void check_ducts() const {
    for (firmware::Quantity q = firmware::first_duct; q < firmware::quantity_count; ++q) {
      const std::vector<double>& duct = values(result_.recording, q);
      for (std::size_t k = 0; k < duct.size(); ++k) {
        if (std::isnan(duct[k])) continue;
        if (const firmware::Objection objection = firmware::object_to(q, duct[k])) {
          throw InputError(table_.source, line_of(table_, k), objection.wrong, objection.expected);
        }
      }
    }
  }

 public:
  // How the stamps were printed.
  [[nodiscard]] firmware::StampRounding stamps() const {
    const TimeMeaning& axis = meaning_.time;
    if (!axis.column || axis.counts) return {};
    const RawColumn& column = table_.columns[*axis.column];
    return {column.decimals, column.significant_digits, std::abs(axis.scale)};
  }

 private:
  static bool strictly_rises(const std::vector<double>& time) {
    return std::adjacent_find(time.begin(), time.end(), std::greater_equal<>()) == time.end();
  }

  RawTable& table_;
  const Interpretation& meaning_;
  const RigContext& rig_;
  bool keep_others_;
  std::vector<double> shared_;  // time of the columns without an own one
  bool shared_is_axis_ = false;
  TableRecording result_;
};

}  // namespace

TableRecording to_recording(RawTable& table, const Interpretation& meaning, const RigContext& rig, bool keep_others) {
  return Builder(table, meaning, rig, keep_others).run();
}

firmware::Recording read_table_recording(RawTable table, const RigContext& rig, firmware::Missing missing) {
  const Interpretation meaning = interpret(table, rig);
  if (missing == firmware::Missing::refuse && !table.faults.empty()) {
    const RawFault& fault = table.faults.front();
    throw InputError(table.source, fault.line, fault.wrong, fault.expected);
  }
  Builder builder(table, meaning, rig, false);
  TableRecording built = builder.run();
  firmware::Recording& recording = built.recording;
  const std::size_t first_line = table.lines.empty() ? 0 : table.lines.front();
  const firmware::RecordingLocation location{table.source, first_line};

  for (const ColumnMeaning& channel : meaning.channels) {
    const std::vector<double>& column = values(recording, channel.quantity);
    for (std::size_t k = 0; k < column.size(); ++k) {
      if (std::isfinite(column[k]) || (missing == firmware::Missing::mark && std::isnan(column[k]))) continue;
      throw InputError(table.source, line_of(table, k),
                       in_quotes(table.columns[channel.column].name) + " is " + shortest(column[k]), "a finite number");
    }
  }
  std::optional<double> expected_rate = rig.rate;
  firmware::StampRounding rounding = builder.stamps();
  if (missing == firmware::Missing::mark) {
    if (firmware::recover_grid(recording, rounding, expected_rate)) rounding = {};
    expected_rate = firmware::rate_if_usual(recording.time, rounding, expected_rate);
    const double period = expected_rate ? 1.0 / *expected_rate : firmware::median_step(recording.time);
    fill_gaps(recording, {}, location, expected_rate, missing, firmware::stamp_error(recording.time, rounding, period));
  }
  firmware::check_time(recording, rounding, location, expected_rate);

  std::string remark;
  for (const std::vector<std::string>* notes :
       {&std::as_const(meaning.notes), &std::as_const(built.notes), &std::as_const(table.notes)}) {
    for (const std::string& note : *notes) remark += (remark.empty() ? "" : "; ") + note;
  }
  for (const LeftOut& one : table.left_out)
    remark += (remark.empty() ? "" : "; ") + in_quotes(one.name) + " is left out: " + one.reason;
  if (!table.faults.empty()) {
    remark += (remark.empty() ? "line " : "; line ") + std::to_string(table.faults.front().line) + ": " +
              table.faults.front().wrong;
    if (table.faults.size() > 1) remark += " and " + std::to_string(table.faults.size() - 1) + " more like it";
  }
  const std::string source = firmware::one_line(table.source) + ": ";
  if (recording.remark.starts_with(source)) recording.remark.erase(0, source.size());
  if (!remark.empty() || !recording.remark.empty()) {
    recording.remark = source + firmware::one_line(remark) + (remark.empty() || recording.remark.empty() ? "" : "; ") +
                       recording.remark;
  }
  return std::move(recording);
}

}  // namespace host_sim
