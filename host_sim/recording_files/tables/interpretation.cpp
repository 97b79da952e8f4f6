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

std::string list_of_columns(const RawTable& table) {
  std::string list;
  constexpr std::size_t most = 12;
  for (std::size_t c = 0; c < std::min(table.columns.size(), most); ++c) {
    list += (list.empty() ? "" : ", ") + in_quotes(table.columns[c].name);
    if (!table.columns[c].unit.empty()) list += " [" + table.columns[c].unit + "]";
  }
  return list + (table.columns.size() > most ? ", …" : "");
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

bool rises(const std::vector<double>& values) {
  std::size_t falls = 0;
  for (std::size_t k = 1; k < values.size(); ++k) falls += values[k] > values[k - 1] ? 0 : 1;
  return values.size() > 1 && falls * 100 < values.size();
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
  Interpreter(const RawTable& table, const RigContext& rig)
      : table_(table), rig_(rig), used_(table.columns.size(), false) {}

  Interpretation run() {
    take_mapped_channels();
    take_own_names();
    find_time();
    take_guesses();
    if (result_.channels.empty()) {
      throw InputError(table_.source, table_.header_line, "no column is a known channel: " + list_of_columns(table_),
                       "a name such as z_w, F or 'Weg Rad [mm]', or entries in the rig description's [channels]");
    }
    result_.notes.insert(result_.notes.end(), undecided_.begin(), undecided_.end());
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool has_own_axis(std::size_t c) const { return !table_.columns[c].own_time.empty(); }

  std::optional<std::size_t> find_mapped(const std::string& name) const {
    for (const auto member : {&RawColumn::text, &RawColumn::name}) {
      std::optional<std::size_t> found;
      for (std::size_t c = 0; c < table_.columns.size(); ++c) {
        if (table_.columns[c].*member != name) continue;
        if (found)
          throw InputError(table_.source, table_.header_line, "two columns are called " + in_quotes(name), "one");
        found = c;
      }
      if (found) return found;
    }
    // A signal's path in a file of an instrument or a structure: its last part may be named alone.
    std::optional<std::size_t> found;
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const std::string& full = table_.columns[c].name;
      const std::size_t stroke = full.find_last_of("/.");
      if (stroke == std::string::npos || std::string_view(full).substr(stroke + 1) != name) continue;
      if (found)
        throw InputError(table_.source, table_.header_line, "two columns are called " + in_quotes(name), "one");
      found = c;
    }
    return found;
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

  void find_time() {
    if (const auto entry = rig_.channels.find("t"); entry != rig_.channels.end()) {
      if (const std::optional<std::size_t> c = find_mapped(entry->second.column)) {
        return set_time(*c, scale_of(*c, firmware::time_quantity, entry->second.scale), entry->second.offset, "");
      }
    }
    if (!table_.columns.empty() && table_.rows == 0) return;  // every column has its own axis
    std::optional<std::size_t> named;
    std::optional<std::size_t> clock;
    std::optional<std::size_t> number;
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const RawColumn& column = table_.columns[c];
      if (used_[c] || has_own_axis(c)) continue;
      if (column.is_clock) {
        if (!clock) clock = c;
      } else if (is_sample_number_name(column.name)) {
        if (!number) number = c;
      } else if (!named && (is_time_name(column.name) || dimension_of_column(column) == firmware::Dimension::time) &&
                 rises(column.values)) {
        named = c;
      }
    }
    if (named) return take_time_column(*named);
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
        !counts_by_one(table_.columns[0].values) && !dimension_of_column(table_.columns[0])) {
      return take_time_column(0, "the first column, which rises from row to row, ");
    }
    if (!table_.columns.empty() && !used_[0] && counts_by_one(table_.columns[0].values) && rig_.rate) {
      return take_sample_number(0, *rig_.rate, "the rig description's sample_rate");
    }
    throw InputError(table_.source, table_.header_line, "no column is the time: " + list_of_columns(table_),
                     "a column such as t or 'Zeit [ms]', or a sampling rate in the lines above the columns");
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
    if (const std::optional<firmware::Unit> unit = firmware::find_unit(column.unit);
        unit && unit->dimension == firmware::Dimension::time) {
      return set_time(
          c, unit->scale, 0.0,
          column.name == "t" && unit->scale == 1.0 && prefix.empty() ? "" : who + " is the time in " + column.unit);
    }
    if (!column.unit.empty() && firmware::find_unit(column.unit)) scale_of(c, firmware::time_quantity);  // refuses it
    const double step = usual_step(column.values);
    constexpr std::array<std::pair<double, std::string_view>, 4> units{
        {{1.0, "s"}, {1e-3, "ms"}, {1e-6, "µs"}, {1e-9, "ns"}}};
    if (rig_.rate) {
      for (const auto& [scale, unit] : units) {
        if (std::abs(step * scale * *rig_.rate - 1.0) > 0.01) continue;
        return set_time(c, scale, 0.0,
                        column.name == "t" && scale == 1.0
                            ? ""
                            : who + " is the time in " + std::string(unit) + ": so it has the rig's rate");
      }
    }
    if (counts_by_one(column.values) && table_.rate) return take_sample_number(c, *table_.rate, table_.rate_text);
    const bool contract = column.name == "t";  // the recordings' own name: seconds
    const auto& [scale, unit] = contract || step < 0.5 ? units[0]
                                : step < 100.0         ? units[1]
                                : step < 1e5           ? units[2]
                                                       : units[3];
    set_time(
        c, scale, 0.0,
        contract ? "" : who + " looks like the time in " + std::string(unit) + ": its steps are " + six_digits(step));
  }

  void take_sample_number(std::size_t c, double rate, const std::string& from) {
    result_.time.counts = true;
    result_.time.rate = rate;
    set_time(c, 1.0 / rate, 0.0, "t from " + in_quotes(table_.columns[c].text) + " and " + in_quotes(from));
  }

  void take_clock(std::size_t c) {
    set_time(c, 1.0, 0.0, in_quotes(table_.columns[c].text) + " is a clock: t counts from its first stamp");
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
      if (used_[c] || column.is_clock) continue;
      if (std::none_of(column.values.begin(), column.values.end(), [](double v) { return std::isfinite(v); })) continue;
      const std::optional<firmware::Dimension> dimension = dimension_of_column(column);
      if (!column.unit.empty() && !firmware::find_unit(column.unit)) {
        undecided_.push_back(in_quotes(column.text) + " is left out: the unit " + in_quotes(column.unit) +
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
        undecided_.push_back(in_quotes(table_.columns[list[0].first].text) + " and " +
                             in_quotes(table_.columns[list[1].first].text) + " both look like " +
                             std::string(firmware::quantity_name(quantity)) +
                             ": neither is used, name one in the rig description's [channels]");
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

  const RawTable& table_;
  const RigContext& rig_;
  std::vector<bool> used_;
  Interpretation result_;
  std::vector<std::string> undecided_;
};

}  // namespace

Interpretation interpret(const RawTable& table, const RigContext& rig) { return Interpreter(table, rig).run(); }

firmware::ChannelMap channel_map_of(const RawTable& table, const Interpretation& interpretation) {
  firmware::ChannelMap map;
  const auto add = [&](firmware::Quantity quantity, std::size_t column, double scale, double offset) {
    const RawColumn& source = table.columns[column];
    const bool own = source.name == firmware::quantity_name(quantity) && scale == 1.0 && offset == 0.0;
    if (!own) map[std::string(firmware::quantity_name(quantity))] = {source.text, scale, offset};
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
