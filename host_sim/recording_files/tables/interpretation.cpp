#include "host_sim/recording_files/tables/interpretation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/tables/channel_guess.hpp"

namespace host_sim {
namespace {

using firmware::in_quotes;
using firmware::InputError;
using firmware::shortest;

constexpr double longest_travel = 2.0;  // [m] see interpret()

std::string six_digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

std::optional<firmware::Dimension> dimension_of_column(const RawColumn& column) {
  const std::optional<firmware::Unit> unit = firmware::find_unit(column.unit);
  return unit && unit->dimension != firmware::Dimension::none ? std::optional(unit->dimension) : std::nullopt;
}

// Median of the steps of up to 1000 values from the begin; 0 where they do not rise.
double usual_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < std::min<std::size_t>(values.size(), 1001); ++k) {
    const double step = values[k] - values[k - 1];
    if (std::isfinite(step)) steps.push_back(step);
  }
  if (steps.empty()) return 0.0;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return steps[steps.size() / 2];
}

// Whether values rise as stamps do: some may repeat where they are coarser than the period, hardly one falls.
bool rises(const std::vector<double>& values) {
  std::size_t falls = 0;
  std::size_t rising = 0;
  std::size_t count = 0;
  double before = NAN;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    if (count++ > 0) {
      falls += value < before ? 1 : 0;
      rising += value > before ? 1 : 0;
    }
    before = value;
  }
  return count > 1 && falls * 100 < count && 3 * rising >= count - 1;
}

bool counts_by_one(const std::vector<double>& values) {
  if (values.size() < 2 || std::floor(values.front()) != values.front()) return false;
  for (std::size_t k = 1; k < std::min<std::size_t>(values.size(), 1001); ++k) {
    if (values[k] - values[k - 1] != 1.0) return false;
  }
  return true;
}

class Interpreter {
 public:
  Interpreter(RawTable& table, const RigContext& rig) : table_(table), rig_(rig), used_(table.columns.size(), false) {}

  Interpretation run() {
    take_mapped_channels();
    take_own_names();
    find_time();
    take_guesses();
    if (result_.channels.empty() && !rig_.only_list) {
      std::string why = "no column is a known channel: " + list_of_columns(table_);
      if (!undecided_.empty()) why += "; " + undecided_.front();
      throw InputError(table_.source, table_.header_line, why, "the channels to be named: " + suggested_command(false));
    }
    result_.notes.insert(result_.notes.end(), undecided_.begin(), undecided_.end());
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool has_own_axis(std::size_t c) const { return !table_.columns[c].own_time.empty(); }

  [[nodiscard]] std::optional<std::size_t> find_mapped(const std::string& name) const {
    return find_column(table_, name);
  }

  // The command that takes this file, with names of its columns.
  [[nodiscard]] std::string suggested_command(bool needs_time) const {
    std::string command = "rigtwin import " + table_.source;
    if (needs_time) command += " --rate 1000";
    const bool car = rig_.kind && *rig_.kind == model::RigKind::quarter_car;
    const std::array<std::string_view, 2> wanted =
        car ? std::array<std::string_view, 2>{"z_r", "z_w"} : std::array<std::string_view, 2>{"x_act", "F"};
    const std::array<std::string_view, 2> units =
        car ? std::array<std::string_view, 2>{"mm", "mm"} : std::array<std::string_view, 2>{"mm", "N"};
    std::vector<bool> named(table_.columns.size(), false);
    for (std::size_t w = 0; w < wanted.size(); ++w) {
      const std::optional<firmware::Unit> unit = firmware::find_unit(units[w]);
      for (std::size_t c = 0; c < table_.columns.size(); ++c) {
        const RawColumn& column = table_.columns[c];
        if (named[c] || is_any_time(c) || column.is_clock || column.values.empty()) continue;
        if (is_sample_number_name(column.name) || firmware::is_unit_of_no_channel(column.unit)) continue;
        // Of a column that states its unit the dimension must be the channel's.
        const std::optional<firmware::Dimension> dimension = dimension_of_column(column);
        if (dimension && dimension != unit->dimension) continue;
        named[c] = true;
        command += " --map '" + std::string(wanted[w]) + "=" + unique_name(table_, c);
        if (column.unit.empty()) command += " [" + std::string(units[w]) + "]";
        command += "'";
        break;
      }
    }
    if (std::none_of(named.begin(), named.end(), [](bool taken) { return taken; })) command += " --map 'F=COLUMN'";
    return command + " --out REC.csv";
  }
  [[nodiscard]] bool is_any_time(std::size_t c) const {
    return result_.time.column == c || std::find(result_.times.begin(), result_.times.end(), c) != result_.times.end();
  }

  // The scale of a column: that of its entry in [channels], else by its unit.
  double scale_of(std::size_t c, firmware::Quantity quantity, std::optional<double> given = std::nullopt) const {
    const RawColumn& column = table_.columns[c];
    return firmware::column_scale(given, column.unit, quantity, column.name, table_.source, table_.header_line);
  }

  void take(std::size_t c, firmware::Quantity quantity, double scale, double offset, std::string reason) {
    for (const ColumnMeaning& taken : result_.channels) {
      if (taken.column != c) continue;
      throw InputError(table_.source, table_.header_line,
                       "column " + in_quotes(table_.columns[c].name) + " is both " +
                           std::string(firmware::quantity_name(taken.quantity)) + " and " +
                           std::string(firmware::quantity_name(quantity)) + " in [channels]",
                       "one channel for each column");
    }
    result_.channels.push_back({c, quantity, scale, offset, table_.columns[c].unit, std::move(reason)});
    used_[c] = true;
  }

  [[nodiscard]] bool has(firmware::Quantity quantity) const {
    return std::any_of(result_.channels.begin(), result_.channels.end(),
                       [&](const ColumnMeaning& taken) { return taken.quantity == quantity; });
  }

  void take_mapped_channels() {
    for (const auto& [wanted, entry] : rig_.channels) {
      const std::optional<firmware::Quantity> quantity = firmware::find_quantity(wanted);
      if (!quantity || *quantity == firmware::time_quantity) continue;
      const std::optional<std::size_t> c = find_mapped(entry.column);
      if (!c) continue;
      const double scale = scale_of(*c, *quantity, entry.scale);
      if (!entry.scale && scale != 1.0) {
        result_.notes.push_back(in_quotes(table_.columns[*c].text) + " is " + wanted +
                                " by [channels], converted from " + table_.columns[*c].unit);
      }
      take(*c, *quantity, scale, entry.offset, "");
    }
  }

  void take_own_names() {
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const std::optional<firmware::Quantity> quantity = firmware::find_quantity(table_.columns[c].name);
      if (used_[c] || !quantity || *quantity == firmware::time_quantity || has(*quantity)) continue;
      take(c, *quantity, scale_of(c, *quantity), 0.0, "");
      if (result_.channels.back().scale != 1.0) {
        result_.notes.push_back(in_quotes(table_.columns[c].text) + " is converted from " + table_.columns[c].unit);
      }
    }
  }

  // --- Time -------------------------------------------------------------------------------------------------------

  [[nodiscard]] bool may_be_time(std::size_t c) const {
    const RawColumn& column = table_.columns[c];
    if (used_[c] || has_own_axis(c) || column.is_slow || is_sample_number_name(column.name)) return false;
    if (column.is_clock) return false;
    const std::optional<firmware::Dimension> dimension = dimension_of_column(column);
    if (dimension && dimension != firmware::Dimension::time) return false;
    if (!dimension && firmware::is_unit_of_no_channel(column.unit)) return false;
    return (is_time_name(column.name) || is_time_name(column.text) || dimension == firmware::Dimension::time) &&
           rises(column.values);
  }

  void find_time() {
    if (!table_.columns.empty() && table_.rows == 0) return check_own_axes();  // every column has its own axis
    if (rig_.given_rate) {
      result_.time.rate = *rig_.given_rate;
      for (std::size_t c = 0; c < table_.columns.size(); ++c) {
        if (may_be_time(c)) result_.times.push_back(c);
      }
      return;
    }
    if (const auto entry = rig_.channels.find("t"); entry != rig_.channels.end()) {
      if (const std::optional<std::size_t> c = find_mapped(entry->second.column)) {
        if (table_.columns[*c].is_clock) return take_clock(*c);
        if (!entry->second.scale && table_.columns[*c].unit.empty() && table_.columns[*c].name != "t")
          return take_time_column(*c);
        return set_time(*c, scale_of(*c, firmware::time_quantity, entry->second.scale), entry->second.offset, "");
      }
    }
    std::optional<std::size_t> clock;
    std::optional<std::size_t> number;
    std::vector<std::size_t> named;
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const RawColumn& column = table_.columns[c];
      if (used_[c] || has_own_axis(c)) continue;
      if (column.is_clock) {
        if (!clock) clock = c;
      } else if (is_sample_number_name(column.name)) {
        if (!number) number = c;
      } else if (may_be_time(c)) {
        named.push_back(c);
      }
    }
    if (!named.empty()) {
      result_.times = named;
      take_time_column(named.front());
      return take_further_times(named);
    }
    if (table_.rate && !table_.rate_conflict.empty()) {
      throw InputError(table_.source, 0, "the file states two rates: " + table_.rate_conflict,
                       "the right one: " + suggested_command(true));
    }
    if (table_.rate) {
      if (number && rises(table_.columns[*number].values))
        return take_sample_number(*number, *table_.rate, table_.rate_text);
      result_.time.rate = *table_.rate;
      result_.time.reason = "t from the row number and " + in_quotes(table_.rate_text);
      result_.notes.push_back(result_.time.reason);
      return;
    }
    if (clock) return take_clock(*clock);
    if (number && rig_.rate && rises(table_.columns[*number].values)) {
      return take_sample_number(*number, *rig_.rate, "the rig description's sample_rate");
    }
    // A first column that rises evenly is the time, whatever its name.
    if (!table_.columns.empty() && !used_[0] && !has_own_axis(0) && rises(table_.columns[0].values) &&
        !counts_by_one(table_.columns[0].values) && !dimension_of_column(table_.columns[0]) &&
        !firmware::is_unit_of_no_channel(table_.columns[0].unit) && !names_a_signal(table_.columns[0].name) &&
        is_even(table_.columns[0].values)) {
      return take_time_column(0, "the first column, which rises from row to row, ");
    }
    if (!table_.columns.empty() && !used_[0] && counts_by_one(table_.columns[0].values) && rig_.rate) {
      return take_sample_number(0, *rig_.rate, "the rig description's sample_rate");
    }
    if (rig_.only_list) return;
    fail_no_time();
  }

  // Steps of stamps are alike; those of a signal that happens to rise are not.
  static bool is_even(const std::vector<double>& values) {
    const double middle = usual_step(values);
    std::size_t near = 0;
    for (std::size_t k = 1; k < values.size(); ++k)
      near += std::abs(values[k] - values[k - 1] - middle) <= 0.6 * middle;
    return 10 * near >= 9 * (values.size() - 1);
  }

  [[noreturn]] void fail_no_time() const {
    std::string why = "no column is the time: " + list_of_columns(table_);
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const RawColumn& column = table_.columns[c];
      if (!is_time_name(column.name) && !is_time_name(column.text) &&
          dimension_of_column(column) != firmware::Dimension::time)
        continue;
      const auto text = std::find_if(table_.faults.begin(), table_.faults.end(), [&](const RawFault& fault) {
        return fault.wrong.starts_with(in_quotes(column.name) + " is ");
      });
      if (column.values.empty() || text != table_.faults.end()) {
        why += "; " + (text == table_.faults.end() ? in_quotes(column.text) + " holds text that is no time"
                                                   : "line " + std::to_string(text->line) + ": " + text->wrong);
      } else if (!column.is_clock) {
        why += "; " + in_quotes(column.text) + " does not increase";
      }
      break;
    }
    throw InputError(table_.source, table_.header_line, why,
                     "a column such as t or 'Zeit [ms]', a sampling rate in the lines above the columns, or " +
                         suggested_command(true));
  }

  // Every time column after the first governs the columns up to the next one, if its stamps are others.
  void take_further_times(const std::vector<std::size_t>& named) {
    const RawColumn& first = table_.columns[named.front()];
    std::vector<std::size_t> ends(named.begin() + 1, named.end());
    ends.push_back(table_.columns.size());
    for (std::size_t i = 1; i < named.size(); ++i) {
      used_[named[i]] = true;
      const std::size_t end = ends[i];
      bool governs = false;
      for (std::size_t c = named[i] + 1; c < end; ++c) governs = governs || !table_.columns[c].is_clock;
      const bool beside = named[i] == named[i - 1] + 1;  // two notations of one time
      if (!governs || beside) continue;
      const double scale = time_scale(named[i]).first;
      std::vector<double> time = table_.columns[named[i]].values;
      std::vector<std::size_t> rows;
      for (std::size_t k = 0; k < time.size(); ++k) {
        if (std::isfinite(time[k])) rows.push_back(k);
      }
      if (rows.size() < 2) continue;
      // Another count of the same clock, without a common instant: seconds since 1970 beside seconds since the start.
      const double shift = scale * time[rows.front()] - result_.time.scale * first.values[rows.front()];
      const double half_step = 0.5 * scale * usual_step(time);
      bool same_clock = std::abs(shift) > scale * (time[rows.back()] - time[rows.front()]);
      bool same = rows.size() == time.size();
      for (const std::size_t k : rows) {
        const double own = firmware::Target::in_seconds(time[k], scale);
        const double shared = firmware::Target::in_seconds(first.values[k], result_.time.scale);
        same = same && std::abs(own - shared) <= 1e-9 * std::abs(shared);
        same_clock = same_clock && std::abs(own - shared - shift) <= half_step;
        time[k] = own;
      }
      if (same || same_clock) continue;
      std::vector<double> own_time;
      for (const std::size_t k : rows) own_time.push_back(time[k]);
      for (std::size_t c = named[i] + 1; c < end; ++c) {
        RawColumn& column = table_.columns[c];
        if (column.is_clock || column.values.size() != table_.rows) continue;
        std::vector<double> values;
        for (const std::size_t k : rows) values.push_back(column.values[k]);
        column.values = std::move(values);
        column.own_time = own_time;
        column.own_time_name = table_.columns[named[i]].text;
      }
      result_.notes.push_back(in_quotes(table_.columns[named[i]].text) + " is the time of the columns behind it");
    }
    drop_rows_without_time(named.front());
  }

  // The first time column ends before the table where another one is longer.
  void drop_rows_without_time(std::size_t c) {
    const std::vector<double>& time = table_.columns[c].values;
    std::size_t end = time.size();
    while (end > 0 && std::isnan(time[end - 1])) --end;
    if (end == time.size() || end < 2) return;
    for (RawColumn& column : table_.columns) {
      if (column.own_time.empty() && column.values.size() == table_.rows) column.values.resize(end);
    }
    if (table_.lines.size() == table_.rows) table_.lines.resize(end);
    table_.rows = end;
  }

  void set_time(std::size_t c, double scale, double offset, std::string reason) {
    used_[c] = true;
    result_.time.column = c;
    result_.time.scale = scale;
    result_.time.offset = offset;
    result_.time.reason = std::move(reason);
    if (!result_.time.reason.empty()) result_.notes.push_back(result_.time.reason);
  }

  void take_time_column(std::size_t c, const std::string& prefix = "") {
    const RawColumn& column = table_.columns[c];
    const std::string who = prefix + in_quotes(column.text);
    if (!column.unit.empty() && firmware::find_unit(column.unit) &&
        firmware::find_unit(column.unit)->dimension != firmware::Dimension::time) {
      scale_of(c, firmware::time_quantity);  // refuses it
    }
    if (dimension_of_column(column) != firmware::Dimension::time && counts_by_one(column.values) && table_.rate &&
        !rig_.rate) {
      return take_sample_number(c, *table_.rate, table_.rate_text);
    }
    auto [scale, why] = time_scale(c);
    if (why.empty() && prefix.empty()) return set_time(c, scale, 0.0, "");
    set_time(c, scale, 0.0, who + (why.empty() ? " is the time in s" : why));
  }

  // The unit of a time column [s] and how it is known; an empty reason: it needs none.
  std::pair<double, std::string> time_scale(std::size_t c) const {
    const RawColumn& column = table_.columns[c];
    if (const std::optional<firmware::Unit> unit = firmware::find_unit(column.unit);
        unit && unit->dimension == firmware::Dimension::time) {
      return {unit->scale, column.name == "t" && unit->scale == 1.0 ? "" : " is the time in " + column.unit};
    }
    const double step = usual_step(column.values);
    constexpr std::array<std::pair<double, std::string_view>, 4> units{
        {{1.0, "s"}, {1e-3, "ms"}, {1e-6, "µs"}, {1e-9, "ns"}}};
    for (const std::optional<double> rate : {rig_.rate, table_.rate_conflict.empty() ? table_.rate : std::nullopt}) {
      if (!rate) continue;
      for (const auto& [scale, unit] : units) {
        if (std::abs(step * scale * *rate - 1.0) > 0.01) continue;
        if (column.name == "t" && scale == 1.0) return {1.0, ""};
        return {scale, " is the time in " + std::string(unit) + ": so it has " +
                           (rate == rig_.rate ? "the rig's rate" : "the rate of " + in_quotes(table_.rate_text))};
      }
    }
    if (column.name == "t") return {1.0, ""};  // the recordings' own name: seconds
    const double first = first_value(column.values);
    // Seconds since 1970, from 2000 to 2050: the size tells the unit.
    for (const auto& [scale, unit] : units) {
      if (first * scale > 0.946e9 && first * scale < 2.525e9)
        return {scale, " counts " + std::string(unit) + " since 1970"};
    }
    // Days: of spreadsheets since 1899-12-30, of MATLAB since the year 0, of astronomers since 4713 BC or (less
    // 2 400 000.5) since 1858, all from 1990 to 2050. Their steps make sense as days alone: 1 kHz is 1.2e-8 of a day.
    constexpr double day = 86400.0;
    const bool spreadsheet = first > 32874.0 && first < 69807.0;
    const bool matlab = first > 726834.0 && first < 748749.0;
    const bool julian = first > 2447892.0 && first < 2469807.0;
    if ((spreadsheet || matlab || julian) && is_rate(1.0 / (day * step)) && !is_rate(1.0 / step)) {
      const char* const whose = matlab ? " as MATLAB does" : julian ? " as astronomers do" : " as spreadsheets do";
      return {day, std::string(" counts days") + whose};
    }
    // Windows counts units of 100 ns since 1601; from 1990 to 2050.
    if (first > 1.2276e17 && first < 1.4169e17) return {1e-7, " counts units of 100 ns since 1601"};
    std::vector<std::size_t> possible;
    for (std::size_t u = 0; u < units.size(); ++u) {
      if (is_rate(1.0 / (step * units[u].first))) possible.push_back(u);
    }
    if (possible.size() == 1) {
      const auto& [scale, unit] = units[possible[0]];
      return {scale, " looks like the time in " + std::string(unit) + ": its steps are " + six_digits(step)};
    }
    if (rig_.only_list) return {1.0, ": its unit is not stated"};
    if (possible.size() > 1) {
      std::string readings;
      for (const std::size_t u : possible) {
        readings += (readings.empty() ? "" : " or ") + six_digits(1.0 / (step * units[u].first)) + " Hz in " +
                    std::string(units[u].second);
      }
      throw InputError(
          table_.source, table_.header_line,
          "the unit of " + in_quotes(column.text) + " is not stated: steps of " + six_digits(step) + " are " + readings,
          "the unit: rigtwin import " + table_.source + " --time '" + unique_name(table_, c) + " [" +
              std::string(units[possible.back()].second) + "]' --out REC.csv");
    }
    // Slower than a rig and faster than any of its instruments.
    if (step > 0.0 && 1.0 / step > 1e7) {
      throw InputError(
          table_.source, table_.header_line,
          "the unit of " + in_quotes(column.text) + " is not stated: steps of " + six_digits(step) +
              " are no rate in s, ms, µs or ns",
          "the unit: rigtwin import " + table_.source + " --time '" + unique_name(table_, c) + " [h]' --out REC.csv");
    }
    return {step < 1.0 ? 1.0 : 1e-3, " is taken as the time in " + std::string(step < 1.0 ? "s" : "ms")};
  }

  // Rates at which rigs are recorded, 2 Hz … 20 kHz.
  static bool is_rate(double rate) { return rate > 2.0 * (1.0 - 1e-6) && rate < 20e3 * (1.0 + 1e-6); }

  static double first_value(const std::vector<double>& values) {
    const auto found = std::find_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    return found == values.end() ? 0.0 : *found;
  }

  void take_sample_number(std::size_t c, double rate, const std::string& from) {
    result_.time.counts = true;
    result_.time.rate = rate;
    set_time(c, 1.0 / rate, 0.0, "t from " + in_quotes(table_.columns[c].text) + " and " + in_quotes(from));
  }

  void take_clock(std::size_t c) {
    set_time(c, 1.0, 0.0, in_quotes(table_.columns[c].text) + " is a clock: t counts from its first stamp");
  }

  // All columns have an axis of their own; one that holds nothing but a rate given by the user has the rows.
  void check_own_axes() {
    if (!rig_.given_rate) return;
    for (RawColumn& column : table_.columns) {
      column.own_time = firmware::sample_times(column.values.size(), *rig_.given_rate);
    }
  }

  // --- Guesses ----------------------------------------------------------------------------------------------------

  void take_guesses() {
    std::optional<model::RigKind> kind = rig_.kind;
    if (!kind) {
      bool places = false;
      for (const RawColumn& column : table_.columns) places = places || names_a_place(column.name);
      for (const ColumnMeaning& taken : result_.channels) {
        places = places || firmware::quantity_name(taken.quantity).front() == 'z';
      }
      kind = places ? model::RigKind::quarter_car : model::RigKind::component_bench;
    }
    std::map<firmware::Quantity, std::vector<std::pair<std::size_t, ChannelGuess>>> candidates;
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const RawColumn& column = table_.columns[c];
      if (used_[c] || column.is_clock || is_any_time(c)) continue;
      if (std::none_of(column.values.begin(), column.values.end(), [](double v) { return std::isfinite(v); })) continue;
      const std::optional<firmware::Dimension> dimension = dimension_of_column(column);
      if (firmware::is_unit_of_no_channel(column.unit)) continue;
      if (!column.unit.empty() && !firmware::find_unit(column.unit)) {
        undecided_.push_back(in_quotes(column.text) + " is taken for no channel: the unit " + in_quotes(column.unit) +
                             " is not known");
        continue;
      }
      const std::optional<ChannelGuess> guess = guess_channel(column.name, dimension, kind);
      if (guess && !has(guess->quantity)) candidates[guess->quantity].emplace_back(c, *guess);
    }
    for (auto& [quantity, list] : candidates) {
      std::stable_sort(list.begin(), list.end(),
                       [](const auto& a, const auto& b) { return a.second.words > b.second.words; });
      if (list.size() > 1 && list[0].second.words == list[1].second.words) {
        undecided_.push_back(in_quotes(unique_name(table_, list[0].first)) + " and " +
                             in_quotes(unique_name(table_, list[1].first)) + " both look like " +
                             std::string(firmware::quantity_name(quantity)) + ": neither is used, name one: --map '" +
                             std::string(firmware::quantity_name(quantity)) + "=" + unique_name(table_, list[0].first) +
                             "'");
        continue;
      }
      take_guess(list[0].first, list[0].second);
    }
  }

  void take_guess(std::size_t c, const ChannelGuess& guess) {
    const RawColumn& column = table_.columns[c];
    double scale = scale_of(c, guess.quantity);
    const std::string_view si = firmware::quantity_unit(guess.quantity);
    std::string unit = column.unit.empty() ? std::string(si) : column.unit;
    std::string of_unit = column.unit.empty() ? ", no unit is stated" : "";
    if (column.unit.empty() && firmware::dimension_of(guess.quantity) == firmware::Dimension::length) {
      double low = INFINITY;
      double high = -INFINITY;
      for (const double value : column.values) {
        if (std::isnan(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
      if (high - low > longest_travel) {
        scale = 1e-3;
        unit = "mm";
        of_unit = ", no unit is stated and it moves by " + shortest(std::round(high - low)) + ", too much for metres";
      }
    }
    take(c, guess.quantity, scale, 0.0, guess.reason + of_unit);
    result_.channels.back().unit = unit;
    result_.notes.push_back(in_quotes(column.text) + " looks like " +
                            std::string(firmware::quantity_name(guess.quantity)) + (unit.empty() ? "" : " in " + unit) +
                            " (" + guess.reason + of_unit + ")");
  }

  RawTable& table_;
  const RigContext& rig_;
  std::vector<bool> used_;
  Interpretation result_;
  std::vector<std::string> undecided_;
};

}  // namespace

std::string list_of_columns(const RawTable& table) {
  std::string list;
  constexpr std::size_t most = 12;
  for (std::size_t c = 0; c < std::min(table.columns.size(), most); ++c) {
    list += (list.empty() ? "" : ", ") + in_quotes(unique_name(table, c));
    if (!table.columns[c].unit.empty() && table.columns[c].text == table.columns[c].name)
      list += " [" + table.columns[c].unit + "]";
  }
  return list + (table.columns.size() > most ? ", …" : "");
}

std::optional<std::size_t> find_column(const RawTable& table, const std::string& name) {
  const auto full_name = [&](std::size_t c) {
    const RawColumn& column = table.columns[c];
    return column.group.empty() ? column.text : column.group + "/" + column.text;
  };
  const auto only = [&](const auto& fits) {
    std::optional<std::size_t> found;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (!fits(c)) continue;
      if (found) {
        throw InputError(table.source, table.header_line, "two columns are called " + in_quotes(name),
                         full_name(*found) == full_name(c)
                             ? "one"
                             : in_quotes(full_name(*found)) + " or " + in_quotes(full_name(c)));
      }
      found = c;
    }
    return found;
  };
  if (const auto found = only([&](std::size_t c) { return !table.columns[c].group.empty() && full_name(c) == name; }))
    return found;
  if (const auto found = only([&](std::size_t c) { return table.columns[c].text == name; })) return found;
  if (const auto found = only([&](std::size_t c) { return table.columns[c].name == name; })) return found;
  // A signal's path in a file of an instrument or a structure: its last part may be named alone.
  return only([&](std::size_t c) {
    const std::string& full = table.columns[c].name;
    const std::size_t stroke = full.find_last_of("/.");
    return stroke != std::string::npos && std::string_view(full).substr(stroke + 1) == name;
  });
}

Interpretation interpret(RawTable& table, const RigContext& rig) { return Interpreter(table, rig).run(); }

firmware::ChannelMap channel_map_of(const RawTable& table, const Interpretation& interpretation) {
  firmware::ChannelMap map;
  const auto add = [&](firmware::Quantity quantity, std::size_t column, double scale, double offset) {
    const RawColumn& source = table.columns[column];
    const bool own = source.name == firmware::quantity_name(quantity) && scale == 1.0 && offset == 0.0;
    if (!own) map[std::string(firmware::quantity_name(quantity))] = {unique_name(table, column), scale, offset};
  };
  const TimeMeaning& time = interpretation.time;
  if (time.column && !time.counts && !table.columns[*time.column].is_clock) {
    add(firmware::time_quantity, *time.column, time.scale, time.offset);
  }
  for (const ColumnMeaning& channel : interpretation.channels) {
    add(channel.quantity, channel.column, channel.scale, channel.offset);
  }
  return map;
}

}  // namespace host_sim
