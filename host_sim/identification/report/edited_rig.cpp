#include "host_sim/identification/report/edited_rig.hpp"

#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"

namespace host_sim::identification {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

/// "effects.coulomb_friction" of "[effects.coulomb_friction]  # known"; nullopt: no heading.
std::optional<std::string> heading_of(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('[') || line.starts_with("[[")) return std::nullopt;
  const std::size_t end = line.find(']');
  if (end == std::string_view::npos) return std::nullopt;
  return std::string(trimmed(line.substr(1, end - 1)));
}

/// Where key and value of a line stand.
struct Entry {
  std::string key;
  std::size_t from, to;  ///< of the value in the line
};
std::optional<Entry> entry_of(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || trimmed(line).starts_with('#')) return std::nullopt;
  const std::string key(trimmed(line.substr(0, equals)));
  const std::size_t from = line.find_first_not_of(" \t", equals + 1);
  if (key.empty() || from == std::string_view::npos) return std::nullopt;
  std::size_t to = from;
  char quote = 0;
  for (; to < line.size(); ++to) {
    const char c = line[to];
    if (quote != 0) {
      if (c == '\\' && quote == '"') {
        ++to;
      } else if (c == quote) {
        quote = 0;
      }
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      break;
    }
  }
  while (to > from && (line[to - 1] == ' ' || line[to - 1] == '\t' || line[to - 1] == '\r')) --to;
  return Entry{key, from, to};
}

using Lines = std::vector<std::string>;
Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(std::move(line));
  return lines;
}

/// A complete description by table and key, and the lines of each table.
struct Complete {
  std::map<std::pair<std::string, std::string>, std::string> values;
  std::map<std::string, Lines> tables;
  std::vector<std::string> order;
};
Complete complete_of(const firmware::RigDescription& description) {
  Complete all;
  std::string table;
  for (const std::string& line : lines_of(firmware::format_rig(description))) {
    if (const auto heading = heading_of(line)) {
      table = *heading;
      all.order.push_back(table);
      all.tables[table];
      continue;
    }
    const auto entry = entry_of(line);
    if (!entry) continue;
    all.values[{table, entry->key}] = line.substr(entry->from, entry->to - entry->from);
    all.tables[table].push_back(line);
  }
  return all;
}

}  // namespace

std::string edited_rig(const firmware::RigDescription& given, const firmware::RigDescription& found) {
  const Complete before = complete_of(given), after = complete_of(found);
  std::string text, table;
  std::set<std::pair<std::string, std::string>> open;  // values that changed
  for (const auto& [path, value] : after.values) {
    const auto old = before.values.find(path);
    if (old != before.values.end() && old->second != value) open.insert(path);
  }
  for (std::string line : lines_of(given.text)) {
    if (const auto heading = heading_of(line)) {
      table = *heading;
    } else if (const auto entry = entry_of(line)) {
      if (table.starts_with("laws.") && entry->key == "file" && after.tables.contains(table)) {
        // The file lies beside the given description, not beside this one: its points stand here.
        text += "# " + line + "\n";
        for (const std::string& complete : after.tables.at(table)) {
          const auto point = entry_of(complete);
          if (point && (point->key.starts_with("at") || point->key.starts_with("value"))) text += complete + "\n";
        }
        continue;
      }
      const std::pair path(table, entry->key);
      if (open.erase(path) > 0) line.replace(entry->from, entry->to - entry->from, after.values.at(path));
    }
    text += line + "\n";
  }
  for (const std::string& name : after.order) {
    if (before.tables.contains(name)) continue;
    text += "\n[" + name + "]\n";
    for (const std::string& line : after.tables.at(name)) text += line + "\n";
  }
  const std::string complete = firmware::format_rig(found);
  try {
    if (open.empty() && firmware::format_rig(firmware::parse_rig(text, given.source)) == complete) return text;
  } catch (const firmware::InputError&) {  // not to be edited line by line
  }
  return complete;
}

}  // namespace host_sim::identification
