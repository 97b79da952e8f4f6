#include "host_sim/recording_files/text/text_preamble.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

std::string letters_of(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return result;
}

bool contains_any(std::string_view text, std::initializer_list<std::string_view> parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](std::string_view word) { return text.find(word) != std::string_view::npos; });
}

enum class Says : unsigned char { nothing, rate, interval };

Says meaning_of_key(std::string_view key) {
  const std::string text = letters_of(key);
  if (contains_any(text, {"count", "number", "anzahl", "start", "date"})) return Says::nothing;
  const bool sampling =
      contains_any(text, {"sampl", "abtast", "scan", "mess", "acquisition", "logging", "log", "data"});
  if (sampling && contains_any(text, {"rate", "freq"})) return Says::rate;
  if (sampling && contains_any(text, {"interval", "intervall", "period", "zeit", "time", "takt", "schritt"}))
    return Says::interval;
  constexpr std::array<std::string_view, 8> rates{"rate",       "fs", "frequency", "frequenz",
                                                  "samplerate", "hz", "fsample",   "messrate"};
  constexpr std::array<std::string_view, 14> intervals{"dt",        "deltat",      "ts",       "xdelta",  "deltax",
                                                       "increment", "xincrement",  "timestep", "tsample", "intervall",
                                                       "interval",  "wfincrement", "period",   "delta"};
  const auto unit_stripped = letters_of(split_heading(key).name);
  for (const std::string& name : {text, unit_stripped}) {
    if (std::find(rates.begin(), rates.end(), name) != rates.end()) return Says::rate;
    if (std::find(intervals.begin(), intervals.end(), name) != intervals.end()) return Says::interval;
  }
  return Says::nothing;
}

// A number at the begin of the text, with either decimal sign, and the text behind it.
std::optional<double> leading_number(std::string_view text, std::string_view& rest) {
  std::size_t end = 0;
  while (end < text.size() && (std::isdigit(static_cast<unsigned char>(text[end])) != 0 || text[end] == '.' ||
                               text[end] == ',' || text[end] == '-' || text[end] == '+' ||
                               ((text[end] == 'e' || text[end] == 'E') && end + 1 < text.size() &&
                                (std::isdigit(static_cast<unsigned char>(text[end + 1])) != 0 || text[end + 1] == '-' ||
                                 text[end + 1] == '+')))) {
    ++end;
  }
  std::string_view number = text.substr(0, end);
  rest = text.substr(end);
  while (number.ends_with(',') || number.ends_with('.')) number.remove_suffix(1);
  for (const char decimal : {'.', ','}) {
    const auto read = read_text_number(number, decimal);
    if (read && !read->weak) return read->value;
  }
  const auto weak = read_text_number(number, '.');
  return weak ? std::optional(weak->value) : std::nullopt;
}

std::optional<StatedRate> rate_of_line(std::string_view line) {
  std::string_view text = firmware::trimmed(line);
  while (!text.empty() && (text.front() == '#' || text.front() == '%' || text.front() == '/' || text.front() == '!')) {
    text = firmware::trimmed(text.substr(1));
  }
  const std::size_t digit = text.find_first_of("0123456789");
  if (digit == std::string_view::npos || digit == 0 || text.size() > 400) return std::nullopt;
  // The key ends at the first sign between words, or where the number begins.
  std::size_t end = text.find_first_of(":=;\t|");
  if (end == std::string_view::npos || end > digit) end = text.find(',') < digit ? text.find(',') : digit;
  const std::string_view key = text.substr(0, end);
  const Says says = meaning_of_key(key);
  if (says == Says::nothing) return std::nullopt;
  std::string_view value = text.substr(end);
  const std::size_t begin = value.find_first_of("0123456789.,");
  const std::size_t number_at = value.find_first_of("0123456789");
  if (number_at == std::string_view::npos || begin == std::string_view::npos) return std::nullopt;
  // Letters between key and number: another key on the same line.
  if (value.substr(0, number_at).find_first_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ") !=
      std::string_view::npos) {
    return std::nullopt;
  }
  std::string_view rest;
  const std::optional<double> number = leading_number(value.substr(number_at), rest);
  if (!number || !(*number > 0.0)) return std::nullopt;

  std::string_view unit_text = firmware::trimmed(rest);
  while (!unit_text.empty() && (unit_text.front() == ';' || unit_text.front() == ',' || unit_text.front() == '[' ||
                                unit_text.front() == '(' || unit_text.front() == '"' || unit_text.front() == '|')) {
    unit_text = firmware::trimmed(unit_text.substr(1));
  }
  unit_text = unit_text.substr(0, unit_text.find_first_of(" ;,])\t\"|"));
  std::optional<firmware::Unit> unit = firmware::find_unit(unit_text);
  if (!unit) unit = firmware::find_unit(split_heading(key).unit);
  double rate = says == Says::rate ? *number : 1.0 / *number;
  if (unit && unit->dimension == firmware::Dimension::frequency) rate = *number * unit->scale;
  if (unit && unit->dimension == firmware::Dimension::time) rate = 1.0 / (*number * unit->scale);
  if (!std::isfinite(rate) || rate < 1e-3 || rate > 1e7) return std::nullopt;
  // 1/0.001 is 1000 to the last bit but one.
  if (std::abs(rate - std::round(rate)) < 1e-9 * rate) rate = std::round(rate);
  std::string shown(firmware::trimmed(line.substr(0, 60)));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return StatedRate{rate, shown};
}

}  // namespace

std::optional<StatedRate> find_rate(const std::vector<std::string_view>& preamble) {
  for (const std::string_view line : preamble) {
    if (auto rate = rate_of_line(line)) return rate;
  }
  return std::nullopt;
}

}  // namespace host_sim
