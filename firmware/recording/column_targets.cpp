#include "firmware/recording/column_targets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"

namespace firmware {
namespace {

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

double Target::in_seconds(double stamp, double scale) {
  const double divisor = std::round(1.0 / scale);
  return scale < 1.0 && std::abs(scale * divisor - 1.0) < 1e-12 ? stamp / divisor : stamp * scale;
}

double column_scale(std::optional<double> given, std::string_view unit, Quantity quantity, std::string_view column,
                    std::string_view source, std::size_t line) {
  if (given) return *given;
  if (unit.empty()) return 1.0;
  const std::optional<Unit> known = find_unit(unit);
  if (known && known->dimension == dimension_of(quantity)) return known->scale;
  const std::string_view si = quantity_unit(quantity);
  throw InputError(
      source, line,
      in_quotes(column) + ", taken as " + std::string(quantity_name(quantity)) + ", has the unit " + in_quotes(unit),
      (si.empty() ? std::string("none (1 open, 0 closed)") : "a unit of " + std::string(si)) +
          ", or a scale in the rig description's [channels]");
}

std::vector<std::optional<Target>> find_targets(const std::vector<Heading>& headings, const ChannelMap& map,
                                                std::string_view source, std::size_t line) {
  std::vector<std::optional<Target>> targets(headings.size());
  enum class Origin { none, by_map, by_own_name };
  std::array<Origin, quantity_count> origin{};
  const auto scale_of = [&](const Heading& heading, Quantity quantity, std::optional<double> given) {
    return column_scale(given, heading.unit.value_or(""), quantity, heading.name, source, line);
  };

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
    targets[*c] = Target{*q, scale_of(headings[*c], *q, column.scale), column.offset};
    origin[*q] = Origin::by_map;
  }

  for (std::size_t c = 0; c < headings.size(); ++c) {
    if (targets[c]) continue;
    const std::optional<Quantity> q = find_quantity(headings[c].name);
    if (!q || origin[*q] == Origin::by_map) continue;
    if (origin[*q] == Origin::by_own_name) {
      throw InputError(source, line, "two columns are called " + in_quotes(headings[c].name), "one");
    }
    targets[c] = Target{*q, scale_of(headings[c], *q, std::nullopt)};
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
