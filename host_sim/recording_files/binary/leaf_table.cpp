#include "host_sim/recording_files/binary/leaf_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
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
  std::string group;
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
    if (signals_.empty()) find_catman();
    if (signals_.empty()) find_testlab();
    if (signals_.empty()) find_named_matrices();
    if (signals_.empty()) find_groups();
    if (signals_.empty()) find_evenly_sampled();
    if (signals_.empty()) find_without_time();
    if (signals_.empty()) return std::nullopt;
    list_left_out();
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
      used_.insert(leaf.path);
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

  static bool has_columns(const Leaf& leaf, std::size_t rows) {
    if (leaf.is_vector() && leaf.numbers.size() == rows) return true;
    if (leaf.kind != LeafKind::numbers || leaf.shape.size() != 2) return false;
    const std::size_t n = leaf.shape[0];
    const std::size_t m = leaf.shape[1];
    return leaf.numbers.size() == n * m &&
           ((n == rows && m <= most_columns_of_matrix) || (m == rows && n <= most_columns_of_matrix));
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
      signal.group = parent(time.path);
      used_.insert(leaf.path);
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

  // --- catman: Channel_2_Data beside Channel_2_Header.SignalName ----------------------------------------------------

  void find_catman() {
    constexpr std::string_view data = "_Data";
    struct Entry {
      Signal signal;
      bool is_time;
    };
    std::vector<Entry> entries;
    std::optional<double> rate;
    for (const Leaf& leaf : leaves_) {
      if (last_part(leaf.path) == "SampleFrequency" && leaf.numbers.size() == 1 && leaf.numbers[0] > 0.0)
        rate = leaf.numbers[0];
      if (!leaf.is_vector() || !leaf.path.ends_with(data)) continue;
      const std::string header = leaf.path.substr(0, leaf.path.size() - data.size()) + "_Header";
      const std::string name = text_at(child(header, "SignalName"));
      if (name.empty()) continue;
      used_.insert(leaf.path);
      Signal signal;
      signal.name = name;
      signal.path = name;
      signal.unit = text_at(child(header, "Unit"));
      signal.values = leaf.numbers;
      entries.push_back({std::move(signal), is_time_name(name)});
    }
    // Each time governs the channels of its length up to the next one.
    const Entry* time = nullptr;
    for (Entry& entry : entries) {
      if (entry.is_time) {
        time = &entry;
        continue;
      }
      if (time != nullptr && time->signal.values.size() == entry.signal.values.size()) {
        entry.signal.time = time->signal.values;
        entry.signal.time_unit = time->signal.unit;
        entry.signal.time_name = time->signal.name;
      } else if (rate) {
        entry.signal.time = even_times(entry.signal.values.size(), 0.0, *rate);
        entry.signal.time_unit = "s";
        entry.signal.time_name = "t";
      } else {
        table_.left_out.push_back(
            {entry.signal.name, count_text(entry.signal.values.size()) + ", no time of this length"});
        continue;
      }
      signals_.push_back(std::move(entry.signal));
    }
  }

  static std::string count_text(std::size_t count) {
    return std::to_string(count) + (count == 1 ? " value" : " values");
  }

  static std::vector<double> even_times(std::size_t count, double begin, double rate) {
    std::vector<double> time(count);
    for (std::size_t k = 0; k < count; ++k) time[k] = begin + static_cast<double>(k) / rate;
    return time;
  }

  // --- Testlab: S.x_values.start_value, .increment and S.y_values.values --------------------------------------------

  void find_testlab() {
    for (const Leaf& leaf : leaves_) {
      const std::string ending = std::string("y_values") + separator_ + "values";
      if (leaf.kind != LeafKind::numbers || !leaf.path.ends_with(ending)) continue;
      const std::string signal_path = parent(parent(leaf.path));
      const Leaf* increment = find(child(child(signal_path, "x_values"), "increment"));
      if (increment == nullptr || increment->numbers.size() != 1 || !(increment->numbers[0] > 0.0)) continue;
      const Leaf* start = find(child(child(signal_path, "x_values"), "start_value"));
      std::size_t rows = leaf.shape.empty() ? 0 : *std::max_element(leaf.shape.begin(), leaf.shape.end());
      const auto columns = columns_of(leaf, rows);
      const std::string name = text_at(child(child(signal_path, "function_record"), "name"));
      for (std::size_t c = 0; c < columns.size(); ++c) {
        Signal signal;
        signal.name = name.empty() ? last_part(signal_path) : name;
        if (columns.size() > 1) signal.name += "(:," + std::to_string(c + 1) + ")";
        signal.path = signal.name;
        signal.group = signal_path;
        signal.unit = text_at(child(child(parent(leaf.path), "quantity"), "label"));
        signal.values = columns[c];
        const double rate = 1.0 / increment->numbers[0];
        const bool whole = std::abs(rate - std::round(rate)) < 1e-9 * rate;
        signal.time = even_times(rows, start != nullptr && start->numbers.size() == 1 ? start->numbers[0] : 0.0,
                                 whole ? std::round(rate) : rate);
        signal.time_unit = "s";
        signal.time_name = "t";
        used_.insert(leaf.path);
        signals_.push_back(std::move(signal));
      }
    }
  }

  // --- A matrix whose columns are named by an attribute, the time among them -----------------------------------------

  void find_named_matrices() {
    for (const Leaf& leaf : leaves_) {
      if (leaf.kind != LeafKind::numbers || leaf.shape.size() != 2 || leaf.path.find('@') != std::string::npos)
        continue;
      const std::vector<std::string> names = names_of_columns(leaf);
      const std::size_t rows = names.size() == leaf.shape[1] ? leaf.shape[0] : leaf.shape[1];
      if (names.size() < 2 || (names.size() != leaf.shape[0] && names.size() != leaf.shape[1])) continue;
      const auto columns = columns_of(leaf, rows);
      if (columns.size() != names.size()) continue;
      const auto time = std::find_if(names.begin(), names.end(),
                                     [](const std::string& name) { return is_time_name(split_heading(name).name); });
      if (time == names.end()) continue;
      const std::size_t t = static_cast<std::size_t>(time - names.begin());
      std::vector<std::string> units;
      std::string list = unit_of(leaf);
      while (!list.empty()) {
        const std::size_t end = std::min(list.find_first_of("\n,;"), list.size());
        units.push_back(list.substr(0, end));
        list.erase(0, std::min(end + 1, list.size()));
      }
      if (units.size() != names.size()) units.assign(names.size(), "");
      used_.insert(leaf.path);
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (c == t) continue;
        Signal signal;
        signal.name = names[c];
        signal.path = names[c];
        signal.group = last_part(leaf.path);
        signal.unit = units[c];
        signal.values = columns[c];
        signal.time = columns[t];
        signal.time_unit = units[t].empty() ? split_heading(names[t]).unit : units[t];
        signal.time_name = split_heading(names[t]).name;
        signals_.push_back(std::move(signal));
      }
    }
  }

  // --- Nothing that says a time: columns of one length, for a rate that the user gives
  // --------------------------------

  void find_without_time() {
    std::map<std::size_t, std::size_t> lengths;
    const auto rows_of = [](const Leaf& leaf) {
      const bool numbers = leaf.kind == LeafKind::numbers && leaf.path.find('@') == std::string::npos;
      return numbers && !leaf.shape.empty() ? *std::max_element(leaf.shape.begin(), leaf.shape.end()) : std::size_t{0};
    };
    for (const Leaf& leaf : leaves_) {
      if (rows_of(leaf) > 1) ++lengths[rows_of(leaf)];
    }
    std::size_t rows = 0;
    for (const auto& [length, count] : lengths) {
      if (rows == 0 || count >= lengths[rows]) rows = length;
    }
    if (rows < 2) return;
    for (const Leaf& leaf : leaves_) {
      if (rows_of(leaf) != rows) continue;
      const auto columns = columns_of(leaf, rows);
      const std::vector<std::string> names = names_of_columns(leaf);
      for (std::size_t c = 0; c < columns.size(); ++c) {
        Signal signal;
        signal.name = columns.size() == 1 ? last_part(leaf.path)
                      : c < names.size()  ? names[c]
                                          : last_part(leaf.path) + "(:," + std::to_string(c + 1) + ")";
        signal.path = columns.size() == 1 ? leaf.path : signal.name;
        signal.group = parent(leaf.path);
        signal.unit = unit_of(leaf);
        signal.values = columns[c];
        used_.insert(leaf.path);
        signals_.push_back(std::move(signal));
      }
    }
    without_time_ = true;
  }

  // Everything that holds values over time, or cannot be read, and is in no column.
  void list_left_out() {
    std::size_t rows = signals_.front().values.size();
    for (const Leaf& leaf : leaves_) {
      if (leaf.path.find('@') != std::string::npos || used_.contains(leaf.path)) continue;
      if (leaf.kind == LeafKind::complex) table_.left_out.push_back({leaf.path, "complex numbers"});
      if (leaf.kind == LeafKind::other)
        table_.left_out.push_back({leaf.path, leaf.text.empty() ? "neither numbers nor text" : leaf.text});
      if (describes_another(leaf)) continue;
      if (leaf.kind == LeafKind::text && leaf.path.find(separator_, 1) == std::string::npos &&
          leaf.path.find_first_of("({") == std::string::npos)
        table_.left_out.push_back({leaf.path, "text"});
      if (leaf.kind != LeafKind::numbers || is_axis(leaf) || leaf.path.find_first_of("#") != std::string::npos)
        continue;
      if (leaf.numbers.empty()) {
        table_.left_out.push_back({leaf.path, "empty"});
      } else if (leaf.is_vector() ? leaf.numbers.size() > 1 : true) {
        table_.left_out.push_back({leaf.path, count_text(leaf.numbers.size()) +
                                                  (leaf.is_vector() ? "" : " in an array") + ", the time has " +
                                                  std::to_string(rows)});
      }
    }
  }

  // "Oil_unit" beside "Oil".
  [[nodiscard]] bool describes_another(const Leaf& leaf) const {
    for (const std::string_view ending : {"_unit", "_name", "_units", "_Unit"}) {
      if (leaf.kind == LeafKind::text && leaf.path.ends_with(ending) &&
          find(leaf.path.substr(0, leaf.path.size() - ending.size())) != nullptr)
        return true;
    }
    return false;
  }

  // The digits at the end of a name: time2 belongs to Weg2.
  static std::string_view number_at_end(std::string_view name) {
    std::size_t begin = name.size();
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(name[begin - 1])) != 0) --begin;
    return name.substr(begin);
  }

  // The time that governs a leaf: of the nearest group, with the same number at its end, the last one before it.
  [[nodiscard]] const Leaf* time_of(const Leaf& leaf, const std::vector<const Leaf*>& times) const {
    const Leaf* best = nullptr;
    const auto rank = [&](const Leaf* time) {
      const std::string_view number = number_at_end(last_part_view(time->path));
      const bool same_number = !number.empty() && number == number_at_end(last_part_view(leaf.path));
      return std::pair(parent(time->path).size(), (same_number ? 2 : 0) + (time < &leaf ? 1 : 0));
    };
    for (const Leaf* time : times) {
      const std::string group = parent(time->path);
      const bool inside =
          parent(leaf.path) == group ||
          (separator_ == '/' && leaf.path.starts_with(group + separator_) && !has_time_of_its_own(leaf, group));
      if (!inside || !has_columns(leaf, time->numbers.size())) continue;
      if (best == nullptr || rank(time) >= rank(best)) {
        // Of two times before the leaf the later one counts; behind it, the first.
        if (best != nullptr && rank(time) == rank(best) && time > &leaf) continue;
        best = time;
      }
    }
    return best;
  }
  [[nodiscard]] std::string_view last_part_view(const std::string& path) const {
    const std::size_t at = path.rfind(separator_);
    return at == std::string::npos ? std::string_view(path) : std::string_view(path).substr(at + 1);
  }

  void find_groups() {
    std::vector<const Leaf*> times;
    for (const Leaf& time : leaves_) {
      if (!time.is_vector() || time.numbers.size() < 2 || !is_time_name(last_part(time.path))) continue;
      if (time.path.find('@') != std::string::npos) continue;
      times.push_back(&time);
    }
    for (const Leaf* governing : times) {
      const Leaf& time = *governing;
      if (!time.is_vector() || time.numbers.size() < 2 || !is_time_name(last_part(time.path))) continue;
      const std::string group = parent(time.path);
      for (const Leaf& leaf : leaves_) {
        if (&leaf == &time || is_axis(leaf) || leaf.path.find('@') != std::string::npos) continue;
        if (time_of(leaf, times) != &time) continue;
        std::string name = last_part(leaf.path);
        std::string unit = unit_of(leaf);
        if (std::string own = text_at(leaf.path + "_name"); !own.empty()) name = own;
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
    for (const std::string_view line : views) {
      if (auto rate = find_rate({line})) return rate;
    }
    return std::nullopt;
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
        signal.group = parent(leaf.path);
        used_.insert(leaf.path);
        table_.rate_text = rate->text;
        signals_.push_back(std::move(signal));
      }
    }
    if (!signals_.empty()) table_.notes.push_back("t from the row number and '" + table_.rate_text + "'");
  }

  // --- Columns -----------------------------------------------------------------------------------------------------

  void make_columns() {
    const Signal& first = signals_.front();
    if (without_time_) table_.rows = first.values.size();
    const bool one_axis =
        std::all_of(signals_.begin(), signals_.end(), [&](const Signal& signal) { return signal.time == first.time; });
    if (one_axis && !without_time_) {
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
      column.group = signal.group;
      while (column.group.starts_with('/')) column.group.erase(0, 1);
      if (!one_axis) {
        column.own_time_name = signal.time_name;
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
  std::set<std::string, std::less<>> used_;  // paths of leaves that are columns
  bool without_time_ = false;
  RawTable table_;
};

}  // namespace

std::optional<RawTable> table_of_leaves(const std::vector<Leaf>& leaves, char separator, std::string_view source,
                                        std::string_view format) {
  return LeafTable(leaves, separator, source, format).run();
}

}  // namespace host_sim
