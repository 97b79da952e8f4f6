#include "host_sim/recording_files/binary/leaf_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/units.hpp"
#include "host_sim/recording_files/tables/channel_guess.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/text_preamble.hpp"

namespace host_sim {
namespace {

constexpr std::size_t most_columns_of_matrix = 64;

// A signal and its time axis, before it is known whether all have the same.
struct Signal {
  std::string name;
  std::string path;
  std::string unit;
  std::vector<double> values;
  std::vector<double> time;  // as in the file; empty: the rate holds
  std::string time_unit;
  std::string time_name;
};

std::string lower_letters(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

class LeafTable {
 public:
  LeafTable(const std::vector<Leaf>& leaves, char separator, std::string_view source, std::string_view format)
      : leaves_(leaves), separator_(separator) {
    table_.source = source;
    table_.format = format;
    for (const Leaf& leaf : leaves) by_path_.emplace(leaf.path, &leaf);
  }

  std::optional<RawTable> run() {
    find_dspace();
    if (signals_.empty()) find_simulink();
    if (signals_.empty()) find_groups();
    if (signals_.empty()) find_evenly_sampled();
    if (signals_.empty()) return std::nullopt;
    make_columns();
    return std::move(table_);
  }

 private:
  [[nodiscard]] const Leaf* find(const std::string& path) const {
    const auto found = by_path_.find(path);
    return found == by_path_.end() ? nullptr : found->second;
  }
  [[nodiscard]] std::string text_at(const std::string& path) const {
    const Leaf* leaf = find(path);
    if (leaf == nullptr) leaf = find(path + "{1}");
    return leaf != nullptr && leaf->kind == LeafKind::text ? leaf->text : "";
  }
  [[nodiscard]] std::string parent(const std::string& path) const {
    const std::size_t at = path.rfind(separator_);
    return at == std::string::npos ? "" : path.substr(0, at);
  }
  [[nodiscard]] std::string last_part(const std::string& path) const {
    const std::size_t at = path.rfind(separator_);
    return at == std::string::npos ? path : path.substr(at + 1);
  }
  [[nodiscard]] std::string child(const std::string& of, const std::string& name) const {
    return of.empty() && separator_ == '.' ? name : of + separator_ + name;
  }

  // --- dSPACE ------------------------------------------------------------------------------------------------------

  void find_dspace() {
    for (const Leaf& leaf : leaves_) {
      if (!leaf.is_vector() || last_part(leaf.path) != "Data") continue;
      const std::string element = parent(leaf.path);  // "S.Y(2)"
      const std::string field = last_part(element);
      if (field != "Y" && !field.starts_with("Y(")) continue;
      const std::string structure = parent(element);
      const Leaf* axis = dspace_axis(structure, element, leaf.numbers.size());
      if (axis == nullptr) continue;
      Signal signal;
      signal.name = text_at(child(element, "Name"));
      if (signal.name.empty()) signal.name = element;
      strip_quotes(signal.name);
      signal.path = signal.name;
      signal.unit = text_at(child(element, "Unit"));
      signal.values = leaf.numbers;
      signal.time = axis->numbers;
      signal.time_unit = text_at(child(parent(axis->path), "Unit"));
      signal.time_name = "X.Data";
      signals_.push_back(std::move(signal));
    }
  }

  static void strip_quotes(std::string& name) {
    std::erase(name, '"');
    while (!name.empty() && name.back() == ' ') name.pop_back();
  }

  [[nodiscard]] const Leaf* dspace_axis(const std::string& structure, const std::string& element,
                                        std::size_t length) const {
    std::vector<const Leaf*> axes;
    for (const Leaf& leaf : leaves_) {
      if (!leaf.is_vector() || last_part(leaf.path) != "Data" || parent(parent(leaf.path)) != structure) continue;
      const std::string field = last_part(parent(leaf.path));
      if (field == "X" || field.starts_with("X(")) axes.push_back(&leaf);
    }
    if (axes.empty()) return nullptr;
    const Leaf* index = find(child(element, "XIndex"));
    if (index != nullptr && index->numbers.size() == 1) {
      for (const double first : {1.0, 0.0}) {  // counted from 1 in MATLAB, from 0 in the program
        const double at = index->numbers[0] - first;
        if (at >= 0.0 && at < static_cast<double>(axes.size()) &&
            axes[static_cast<std::size_t>(at)]->numbers.size() == length) {
          return axes[static_cast<std::size_t>(at)];
        }
      }
    }
    const std::string raster = text_at(child(element, "Raster"));
    for (const bool by_raster : {true, false}) {
      for (const Leaf* axis : axes) {
        if (axis->numbers.size() != length) continue;
        if (!by_raster || (!raster.empty() && text_at(child(parent(axis->path), "Raster")) == raster)) return axis;
      }
    }
    return nullptr;
  }

  // --- Simulink ----------------------------------------------------------------------------------------------------

  void find_simulink() {
    for (const Leaf& leaf : leaves_) {
      if (lower_letters(last_part(leaf.path)) != "values" || leaf.kind != LeafKind::numbers) continue;
      const std::string element = parent(leaf.path);  // "S.signals(2)"
      if (!last_part(element).starts_with("signals")) continue;
      const Leaf* time = find(child(parent(element), "time"));
      if (time == nullptr || !time->is_vector()) continue;
      std::string label = text_at(child(element, "label"));
      if (label.empty()) label = text_at(child(element, "blockName"));
      take_signals(leaf, label.empty() ? last_part(element) : label, text_at(child(element, "unit")), *time);
    }
  }

  // --- Groups with a time vector -----------------------------------------------------------------------------------

  // The columns of an array along the axis of `rows` samples; none if it has no such axis or too many columns.
  static std::vector<std::vector<double>> columns_of(const Leaf& leaf, std::size_t rows) {
    std::vector<std::vector<double>> columns;
    if (leaf.is_vector() && leaf.numbers.size() == rows) return {leaf.numbers};
    if (leaf.kind != LeafKind::numbers || leaf.shape.size() != 2) return columns;
    const std::size_t n = leaf.shape[0];
    const std::size_t m = leaf.shape[1];
    if (leaf.numbers.size() != n * m) return columns;
    if (n == rows && m <= most_columns_of_matrix) {
      for (std::size_t c = 0; c < m; ++c) {
        const auto begin = leaf.numbers.begin() + static_cast<std::ptrdiff_t>(c * n);
        columns.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(n));
      }
    } else if (m == rows && n <= most_columns_of_matrix) {
      for (std::size_t c = 0; c < n; ++c) {
        columns.emplace_back(m);
        for (std::size_t k = 0; k < m; ++k) columns.back()[k] = leaf.numbers[c + k * n];
      }
    }
    return columns;
  }

  // Names of a matrix's columns as attributes or properties list them, one a line.
  [[nodiscard]] std::vector<std::string> names_of_columns(const Leaf& leaf) const {
    std::vector<std::string> names;
    for (const char* key : {"@columns", "@names", "@channels", "@column_names", "@channel_names", "@labels"}) {
      std::string list = text_at(leaf.path + key);
      if (list.empty()) list = text_at(parent(leaf.path) + key);
      while (!list.empty()) {
        const std::size_t end = std::min(list.find_first_of("\n,;"), list.size());
        names.push_back(list.substr(0, end));
        list.erase(0, std::min(end + 1, list.size()));
      }
      if (!names.empty()) break;
    }
    return names;
  }

  void take_signals(const Leaf& leaf, const std::string& name, const std::string& unit, const Leaf& time) {
    const auto columns = columns_of(leaf, time.numbers.size());
    const std::vector<std::string> names = names_of_columns(leaf);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      Signal signal;
      signal.name = columns.size() == 1 ? name
                    : c < names.size()  ? names[c]
                                        : name + "(:," + std::to_string(c + 1) + ")";
      signal.path = columns.size() == 1 ? leaf.path : signal.name;
      signal.unit = unit;
      signal.values = columns[c];
      signal.time = time.numbers;
      signal.time_unit = unit_of(time);
      signal.time_name = last_part(time.path);
      signals_.push_back(std::move(signal));
    }
  }

  [[nodiscard]] std::string unit_of(const Leaf& leaf) const {
    for (const char* key :
         {"@unit", "@units", "@Unit", "@Units", "@UNIT", "@unit_string", "@EngineeringUnits", "@y_unit"}) {
      if (std::string unit = text_at(leaf.path + key); !unit.empty()) return unit;
    }
    const std::string group = parent(leaf.path);
    const std::string name = last_part(leaf.path);
    for (const char* list : {"Units", "units", "Unit", "unit"}) {
      if (std::string unit = text_at(child(child(group, list), name)); !unit.empty()) return unit;
    }
    for (const char* suffix : {"_unit", "_Unit", "_units", "Unit"}) {
      if (std::string unit = text_at(leaf.path + suffix); !unit.empty()) return unit;
    }
    return unit_by_properties(group, name);
  }

  // Properties.VariableNames and .VariableUnits of a timetable.
  [[nodiscard]] std::string unit_by_properties(const std::string& group, const std::string& name) const {
    const std::string properties = child(group, "Properties");
    std::size_t position = 0;
    for (std::size_t i = 1; i <= 1000; ++i) {
      const Leaf* cell = find(child(properties, "VariableNames") + "{" + std::to_string(i) + "}");
      if (cell == nullptr) break;
      if (cell->text == name) position = i;
    }
    const bool named = find(child(properties, "VariableNames") + "{1}") != nullptr;
    if (position == 0 && named) return "";
    if (!named) {
      // Without names the units are in the order of the variables; the time is none of them.
      std::size_t count = 0;
      for (const Leaf& leaf : leaves_) {
        if (parent(leaf.path) != group || leaf.kind != LeafKind::numbers || is_time_name(last_part(leaf.path)))
          continue;
        ++count;
        if (last_part(leaf.path) == name) position = count;
      }
    }
    return text_at(child(properties, "VariableUnits") + "{" + std::to_string(position) + "}");
  }

  void find_groups() {
    for (const Leaf& time : leaves_) {
      if (!time.is_vector() || time.numbers.size() < 2 || !is_time_name(last_part(time.path))) continue;
      if (time.path.find('@') != std::string::npos) continue;
      const std::string group = parent(time.path);
      for (const Leaf& leaf : leaves_) {
        const bool inside =
            parent(leaf.path) == group ||
            (separator_ == '/' && leaf.path.starts_with(group + separator_) && !has_time_of_its_own(leaf, group));
        if (!inside || &leaf == &time || is_axis(leaf) || leaf.path.find('@') != std::string::npos) continue;
        std::string name = last_part(leaf.path);
        std::string unit = unit_of(leaf);
        // A time series' values are called Data; its name stands beside.
        if (lower_letters(name) == "data" || lower_letters(name) == "values") {
          if (std::string own = text_at(child(group, "Name")); !own.empty()) {
            name = own;
          } else if (!group.empty()) {
            name = last_part(group);
          }
          if (unit.empty()) unit = text_at(child(child(group, "DataInfo"), "Units"));
          if (unit.empty()) unit = text_at(child(group, "Unit"));
          if (unit.empty()) unit = text_at(child(group, "Units"));
        }
        take_signals(leaf, name, unit, time);
      }
    }
  }

  [[nodiscard]] bool is_axis(const Leaf& leaf) const { return leaf.is_vector() && is_time_name(last_part(leaf.path)); }

  [[nodiscard]] bool has_time_of_its_own(const Leaf& leaf, const std::string& outer) const {
    for (std::string group = parent(leaf.path); group.size() > outer.size(); group = parent(group)) {
      for (const Leaf& other : leaves_) {
        if (parent(other.path) == group && is_axis(other)) return true;
      }
    }
    return false;
  }

  // --- Signals without a time vector -------------------------------------------------------------------------------

  [[nodiscard]] std::optional<StatedRate> rate_of(const Leaf& leaf) const {
    std::vector<std::string> candidates;
    for (const Leaf& other : leaves_) {
      if (other.numbers.size() != 1) continue;
      const std::size_t mark = other.path.find('@');
      const std::string owner = mark == std::string::npos ? parent(other.path) : other.path.substr(0, mark);
      const std::string key = mark == std::string::npos ? last_part(other.path) : other.path.substr(mark + 1);
      const bool concerns = owner.empty() || owner == "/" || leaf.path == owner ||
                            leaf.path.starts_with(owner + separator_) ||
                            owner == child(parent(leaf.path), "Properties");
      if (concerns) candidates.push_back(key + ": " + firmware::shortest(other.numbers[0]));
    }
    std::vector<std::string_view> views(candidates.begin(), candidates.end());
    std::reverse(views.begin(), views.end());  // the nearest first: children follow their groups
    return find_rate(views);
  }

  void find_evenly_sampled() {
    std::size_t longest = 0;
    for (const Leaf& leaf : leaves_) {
      if (leaf.path.find('@') == std::string::npos && leaf.kind == LeafKind::numbers && !leaf.shape.empty()) {
        longest = std::max(longest, *std::max_element(leaf.shape.begin(), leaf.shape.end()));
      }
    }
    for (const Leaf& leaf : leaves_) {
      if (leaf.path.find('@') != std::string::npos || longest < 2) continue;
      const std::size_t rows = leaf.shape.empty() ? 0 : *std::max_element(leaf.shape.begin(), leaf.shape.end());
      const auto columns = rows < 2 ? std::vector<std::vector<double>>{} : columns_of(leaf, rows);
      if (columns.empty()) continue;
      const std::optional<StatedRate> rate = rate_of(leaf);
      if (!rate) continue;
      const std::vector<std::string> names = names_of_columns(leaf);
      for (std::size_t c = 0; c < columns.size(); ++c) {
        Signal signal;
        signal.name = columns.size() == 1 ? last_part(leaf.path)
                      : c < names.size()  ? names[c]
                                          : last_part(leaf.path) + "(:," + std::to_string(c + 1) + ")";
        signal.path = columns.size() == 1 ? leaf.path : signal.name;
        signal.unit = unit_of(leaf);
        signal.values = columns[c];
        signal.time.resize(rows);
        for (std::size_t k = 0; k < rows; ++k) signal.time[k] = static_cast<double>(k) / rate->rate;
        signal.time_unit = "s";
        signal.time_name = "t";
        table_.rate_text = rate->text;
        signals_.push_back(std::move(signal));
      }
    }
    if (!signals_.empty()) table_.notes.push_back("t from the row number and '" + table_.rate_text + "'");
  }

  // --- Columns -----------------------------------------------------------------------------------------------------

  void make_columns() {
    const Signal& first = signals_.front();
    const bool one_axis =
        std::all_of(signals_.begin(), signals_.end(), [&](const Signal& signal) { return signal.time == first.time; });
    if (one_axis) {
      RawColumn time{first.time_name};
      time.text = first.time_name;
      time.unit = first.time_unit;
      time.values = first.time;
      table_.rows = first.time.size();
      table_.columns.push_back(std::move(time));
    }
    for (Signal& signal : signals_) {
      RawColumn column{signal.name};
      column.text = signal.path;
      column.unit = signal.unit;
      if (column.unit.empty()) {
        const NameAndUnit heading = split_heading(signal.name);
        column.name = heading.name;
        column.unit = heading.unit;
      }
      column.values = std::move(signal.values);
      if (!one_axis) {
        const std::optional<firmware::Unit> unit = firmware::find_unit(signal.time_unit);
        const double scale = unit && unit->dimension == firmware::Dimension::time ? unit->scale : 1.0;
        for (double& t : signal.time) t *= scale;
        column.own_time = std::move(signal.time);
      }
      table_.columns.push_back(std::move(column));
    }
  }

  const std::vector<Leaf>& leaves_;
  char separator_;
  std::map<std::string, const Leaf*, std::less<>> by_path_;
  std::vector<Signal> signals_;
  RawTable table_;
};

}  // namespace

std::optional<RawTable> table_of_leaves(const std::vector<Leaf>& leaves, char separator, std::string_view source,
                                        std::string_view format) {
  return LeafTable(leaves, separator, source, format).run();
}

}  // namespace host_sim
