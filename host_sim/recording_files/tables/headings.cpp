#include "host_sim/recording_files/tables/headings.hpp"

#include <cctype>
#include <optional>

#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"

namespace host_sim {
namespace {

bool is_single_letter(std::string_view text) { return text.size() == 1; }

bool is_channel_unit(std::string_view text) {
  const std::optional<firmware::Unit> unit = firmware::find_unit(text);
  return unit && unit->dimension != firmware::Dimension::none;
}

// "acc_s" is the acceleration of the sprung mass: seconds are the unit of a time alone.
bool may_be_seconds(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const std::string_view word : {"time", "zeit", "delay", "dauer", "duration", "clock", "elapsed", "stamp"}) {
    if (lower.find(word) != std::string::npos) return true;
  }
  return lower == "t";
}

// "Interval"|"ms"|0|0|1: name, unit and what a logger says of its range.
std::string_view without_quotes(std::string_view text) {
  text = firmware::trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return firmware::trimmed(text);
}

}  // namespace

NameAndUnit split_heading(std::string_view heading) {
  const std::string_view text = firmware::trimmed(heading);
  const auto parts = [&](std::size_t name_end, std::string_view unit) {
    std::string_view name = firmware::trimmed(text.substr(0, name_end));
    while (name.ends_with(',') || name.ends_with(':')) name = firmware::trimmed(name.substr(0, name.size() - 1));
    return NameAndUnit{std::string(name), std::string(firmware::trimmed(unit))};
  };
  if (const std::size_t bar = text.find('|'); bar != std::string_view::npos && bar > 0) {
    const std::string_view unit = without_quotes(text.substr(bar + 1, text.find('|', bar + 1) - bar - 1));
    if (unit.empty() || firmware::find_unit(unit) || firmware::is_unit(unit))
      return {std::string(without_quotes(text.substr(0, bar))), std::string(unit)};
  }
  for (const std::string_view brackets : {"[]", "()", "{}", "<>"}) {
    const std::size_t open = text.rfind(brackets[0]);
    if (open == std::string_view::npos || open == 0 || text.back() != brackets[1]) continue;
    const std::string_view inside = text.substr(open + 1, text.size() - open - 2);
    // Round brackets hold other things as well: an index, a remark.
    if (brackets == "[]" || firmware::find_unit(inside) || firmware::is_unit(inside)) return parts(open, inside);
  }
  for (const std::string_view mark : {"/", " in ", ",", ":"}) {
    const std::size_t at = text.rfind(mark);
    if (at == std::string_view::npos || at == 0) continue;
    if (firmware::is_unit(text.substr(at + mark.size()))) return parts(at, text.substr(at + mark.size()));
    // "Beschleunigung / m/s²": the unit has a stroke of its own.
    const std::size_t before = mark == "/" ? text.rfind('/', at - 1) : std::string_view::npos;
    if (before != std::string_view::npos && before != 0 && firmware::is_unit(text.substr(before + 1))) {
      return parts(before, text.substr(before + 1));
    }
  }
  for (const char mark : {' ', '_', '.'}) {
    const std::size_t at = text.rfind(mark);
    if (at == std::string_view::npos || at < 1) continue;
    const std::string_view unit = text.substr(at + 1);
    const bool plausible = is_single_letter(unit) ? mark != '.' && at >= 3 && unit != "h" : true;
    // "Weg in": English "in" is an inch only in brackets.
    if (unit == "s" && !may_be_seconds(text.substr(0, at))) continue;
    if (plausible && unit != "in" && unit != "min" && unit != "h" && is_channel_unit(unit)) return parts(at, unit);
  }
  return {std::string(text), ""};
}

}  // namespace host_sim
