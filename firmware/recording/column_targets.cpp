#include "firmware/recording/column_targets.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/description/text/input_error.hpp"

namespace firmware {
namespace {

// Whether a header's unit is the quantity's SI unit. m/s² is written in many ways; "\xb2" is ² in Latin-1.
bool is_si_unit(std::string_view written, std::string_view si) {
  constexpr std::array<std::string_view, 9> acceleration{"m/s²",  "m/s^2",  "m/s2",  "m/s**2", "m/s\xb2",
                                                         "m s⁻²", "m s^-2", "m·s⁻²", "m*s^-2"};
  constexpr std::array<std::string_view, 3> none{"–", "-", "1"};
  if (si == "m/s²") return std::find(acceleration.begin(), acceleration.end(), written) != acceleration.end();
  if (si.empty()) return std::find(none.begin(), none.end(), written) != none.end();
  return written == si;
}

std::string known_quantities() {
  std::string list;
  for (Quantity q = 1; q < first_duct; ++q) list += std::string(quantity_name(q)) + ", ";
  return list + "duct_1 … duct_6";
}

// Finds the one column that a map entry means: by its full text, else by the name before the unit.
std::optional<std::size_t> find_column(const std::vector<Heading>& headings, std::string_view column,
                                       std::string_view source, std::size_t line) {
  for (const bool by_text : {true, false}) {
    std::optional<std::size_t> found;
    for (std::size_t c = 0; c < headings.size(); ++c) {
      if ((by_text ? headings[c].text : headings[c].name) != column) continue;
      if (found) throw InputError(source, line, "two columns are called " + in_quotes(column), "one");
      found = c;
    }
    if (found) return found;
  }
  return std::nullopt;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return text.substr(text.size());  // empty, and still a place in the text
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

Heading read_heading(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = trimmed(text.substr(1, text.size() - 2));
  Heading heading{std::string(text), std::string(text), std::nullopt};
  const std::size_t bracket = text.rfind('[');
  if (bracket != std::string_view::npos && text.back() == ']') {
    heading.name = trimmed(text.substr(0, bracket));
    const std::string_view in_brackets = trimmed(text.substr(bracket + 1, text.size() - bracket - 2));
    if (!in_brackets.empty()) heading.unit = in_brackets;
  }
  return heading;
}

std::vector<std::optional<Target>> find_targets(const std::vector<Heading>& headings, const ChannelMap& map,
                                                std::string_view source, std::size_t line) {
  std::vector<std::optional<Target>> targets(headings.size());
  enum class Origin { none, by_map, by_own_name };
  std::array<Origin, quantity_count> origin{};

  for (const auto& [wanted, column] : map) {
    const std::optional<Quantity> q = find_quantity(wanted);
    if (!q) continue;
    const std::optional<std::size_t> c = find_column(headings, column.column, source, line);
    if (!c) continue;
    if (targets[*c]) {
      throw InputError(source, line,
                       "column " + in_quotes(column.column) + " is both " +
                           std::string(quantity_name(targets[*c]->quantity)) + " and " +
                           std::string(quantity_name(*q)) + " in [channels]",
                       "one channel for each column");
    }
    targets[*c] = Target{*q, column.scale, column.offset};
    origin[*q] = Origin::by_map;
  }

  for (std::size_t c = 0; c < headings.size(); ++c) {
    if (targets[c]) continue;
    const std::optional<Quantity> q = find_quantity(headings[c].name);
    if (!q || origin[*q] == Origin::by_map) continue;
    if (origin[*q] == Origin::by_own_name) {
      throw InputError(source, line, "two columns are called " + in_quotes(headings[c].name), "one");
    }
    if (headings[c].unit && !is_si_unit(*headings[c].unit, quantity_unit(*q))) {
      const std::string_view si = quantity_unit(*q).empty() ? "none (1 open, 0 closed)" : quantity_unit(*q);
      throw InputError(source, line, headings[c].name + " has the unit " + in_quotes(*headings[c].unit),
                       std::string(si) + ", or a scale in the rig description's [channels]");
    }
    targets[c] = Target{*q};
    origin[*q] = Origin::by_own_name;
  }

  if (origin[time_quantity] == Origin::none) {
    throw InputError(source, line, "there is no column t", "a first column t, in seconds");
  }
  if (std::all_of(origin.begin() + 1, origin.begin() + first_duct, [](Origin o) { return o == Origin::none; })) {
    throw InputError(source, line, "no column is a known channel", "one or more of " + known_quantities());
  }
  return targets;
}

}  // namespace firmware
