#include "host_sim/recording_files/text/text_preamble.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

constexpr double same_rate = 1e-3;  // two statements of one rate, rounded: "3.906E-5 s" and "25600 Hz"
// Rates of measurements; beyond them a number with a doubtful sign is read the other way.
constexpr double slowest_rate = 1.0, fastest_rate = 2e6;  // [Hz]

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

enum class Says : unsigned char { nothing, rate, interval, duration, count };

// What a key states, and whether it speaks of sampling.
struct KeyMeaning {
  Says says = Says::nothing;
  bool of_sampling = false;
};

KeyMeaning meaning_of_key(std::string_view key) {
  const std::string text = letters_of(key);
  const std::string name = letters_of(split_heading(key).name);
  const bool sampling = contains_any(text, {"sampl", "abtast", "scan", "acquisition", "logging", "standardmess",
                                            "erfass", "aufnahme", "tastrate", "daq"});
  const bool measuring = sampling || contains_any(text, {"mess", "log", "data", "record", "aufzeich"});
  if (contains_any(text, {"start", "date", "datum"})) return {};
  if (text == "sampless" || text == "sampless1" || text == "samplespersec") return {Says::rate, true};  // "Samples/s"
  if (contains_any(text, {"count", "number", "anzahl", "numsamples", "numofsamples", "numpoints"}) ||
      text == "samples" || text == "points" || text == "npts")
    return {Says::count};
  // Frequencies that are no rate: of what moves the rig, of a filter.
  if (contains_any(text,
                   {"excit",  "anreg",  "sine",   "sinus",   "filter",    "cutoff",  "grenz",   "eigen", "resonan",
                    "corner", "pass",   "sweep",  "carrier", "bandwidth", "baud",    "bitrate", "test",  "load",
                    "drive",  "spring", "strain", "heart",   "frame",     "refresh", "waveform"}))
    return {};
  if (contains_any(text, {"duration", "dauer", "messzeit", "testzeit", "recordlength", "totaltime", "recordingtime",
                          "measurementtime", "measuringtime", "acquisitiontime", "gesamtzeit"}))
    return {Says::duration};
  if (measuring && contains_any(text, {"rate", "freq"})) return {Says::rate, true};
  if (measuring && contains_any(text, {"interval", "period", "takt", "schritt"})) return {Says::interval, true};
  if (sampling && contains_any(text, {"zeit", "time", "step"})) return {Says::interval, true};
  for (const std::string& one : {text, name}) {
    constexpr std::array<std::string_view, 12> rates{"fs",         "fsample",          "sr",      "fabtast",
                                                     "fa",         "samplespersecond", "sps",     "hzsr",
                                                     "samplefreq", "sampling",         "sampled", "abtastung"};
    constexpr std::array<std::string_view, 13> intervals{
        "dt",       "deltat",  "ts",          "xdelta",    "deltax",        "increment", "xincrement",
        "timestep", "tsample", "wfincrement", "deltatime", "timeincrement", "dtime"};
    constexpr std::array<std::string_view, 4> bare_rates{"rate", "frequency", "frequenz", "hz"};
    constexpr std::array<std::string_view, 6> bare_intervals{"intervall", "interval", "period",
                                                             "delta",     "takt",     "taktzeit"};
    const auto in = [&](const auto& list) { return std::find(list.begin(), list.end(), one) != list.end(); };
    if (in(rates)) return {Says::rate, true};
    if (in(intervals)) return {Says::interval, true};
    if (in(bare_rates)) return {Says::rate};
    if (in(bare_intervals)) return {Says::interval};
  }
  return {};
}

bool is_ascii_digit(char c) { return c >= '0' && c <= '9'; }

// The readings of a number at the begin of the text, the likelier first, and the text behind it.
std::vector<double> leading_numbers(std::string_view text, char decimal, std::string_view& rest) {
  std::size_t end = 0;
  while (end < text.size() &&
         (is_ascii_digit(text[end]) || text[end] == '.' || text[end] == ',' || text[end] == '-' || text[end] == '+' ||
          ((text[end] == 'e' || text[end] == 'E') && end + 1 < text.size() &&
           (is_ascii_digit(text[end + 1]) || text[end + 1] == '-' || text[end + 1] == '+')))) {
    ++end;
  }
  std::string_view number = text.substr(0, end);
  rest = text.substr(end);
  while (number.ends_with(',') || number.ends_with('.')) number.remove_suffix(1);
  std::vector<double> values;
  const char other = decimal == '.' ? ',' : '.';
  const DecimalEvidence evidence = decimal_evidence(number);
  const bool doubtful = evidence == DecimalEvidence::ambiguous;
  const char first = evidence == DecimalEvidence::point ? '.' : evidence == DecimalEvidence::comma ? ',' : decimal;
  if (const auto read = read_text_number(number, first)) values.push_back(read->value);
  if (doubtful || values.empty()) {
    if (const auto read = read_text_number(number, first == decimal ? other : decimal)) values.push_back(read->value);
  }
  return values;
}

// The parts of a line that may hold a key and its value, and what separates them.
std::vector<std::string_view> parts_of(std::string_view line) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    const bool ends = i == line.size() || line[i] == ';' || line[i] == '\t' || line[i] == '|' ||
                      (line[i] == ',' &&
                       !(i > 0 && i + 1 < line.size() && is_ascii_digit(line[i - 1]) && is_ascii_digit(line[i + 1])));
    if (!ends) continue;
    if (const std::string_view part = firmware::trimmed(line.substr(begin, i - begin)); !part.empty())
      parts.push_back(part);
    begin = i + 1;
  }
  return parts;
}

struct Statement {
  double value;                     // rate [Hz], duration [s] or number of samples
  std::optional<double> otherwise;  // the rate if the number's sign means the other thing
  KeyMeaning key;
  std::string line;
};

std::string shown(std::string_view line) {
  std::string text(firmware::trimmed(line.substr(0, 60)));
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return text;
}

// A unit that is neither a frequency nor a time behind the number: then the number is no rate.
bool is_foreign(std::string_view unit) {
  if (unit.empty()) return false;
  if (const std::optional<firmware::Unit> known = firmware::find_unit(unit)) {
    return known->dimension != firmware::Dimension::frequency && known->dimension != firmware::Dimension::time &&
           known->dimension != firmware::Dimension::none;
  }
  const std::string letters = letters_of(unit);
  return firmware::is_unit_of_no_channel(unit) || unit.find('/') != std::string_view::npos ||
         contains_any(letters, {"bit", "baud", "byte", "bps"});
}

// What a key and the text behind it state.
std::optional<Statement> statement_of(std::string_view key, std::string_view value, std::string_view next,
                                      std::string_view line, char decimal) {
  // "Config: data_rate": the word before the value counts.
  if (const std::size_t mark = key.find_last_of(":="); mark != std::string_view::npos) key = key.substr(mark + 1);
  const KeyMeaning meaning = meaning_of_key(key);
  if (meaning.says == Says::nothing) return std::nullopt;
  value = firmware::trimmed(value);
  while (value.starts_with('"') || value.starts_with('[') || value.starts_with('(')) value.remove_prefix(1);
  if (value.empty() || (!is_ascii_digit(value[0]) && value[0] != '.' && value[0] != ',')) return std::nullopt;
  std::string_view rest;
  const std::vector<double> numbers = leading_numbers(value, decimal, rest);
  if (numbers.empty() || !(numbers[0] > 0.0)) return std::nullopt;
  if (rest.starts_with(':')) return std::nullopt;  // a clock
  std::string_view unit_text = firmware::trimmed(rest);
  if (unit_text.empty()) unit_text = next;  // "Abtastrate;1000;Hz"
  const bool in_brackets = unit_text.starts_with('[') || unit_text.starts_with('(');
  while (!unit_text.empty() && (unit_text.front() == '[' || unit_text.front() == '(' || unit_text.front() == '"')) {
    unit_text = firmware::trimmed(unit_text.substr(1));
  }
  const std::string_view whole = unit_text.substr(0, unit_text.find_first_of("])\""));
  unit_text = unit_text.substr(0, unit_text.find_first_of(" ;,])\t\"|"));
  if (firmware::find_unit(whole)) unit_text = whole;  // "samples / s"
  if (unit_text == "/s" || unit_text == "/sec") unit_text = "1/s";
  if (!in_brackets && is_foreign(unit_text)) return std::nullopt;
  std::optional<firmware::Unit> unit = firmware::find_unit(unit_text);
  if (!unit && !letters_of(key).starts_with("samples")) unit = firmware::find_unit(split_heading(key).unit);
  const auto to_rate = [&](double number) {
    double rate = meaning.says == Says::rate ? number : 1.0 / number;
    if (unit && unit->dimension == firmware::Dimension::frequency) rate = number * unit->scale;
    if (unit && unit->dimension == firmware::Dimension::time) rate = 1.0 / (number * unit->scale);
    // 1/0.001 is 1000 to the last bit but one.
    if (std::abs(rate - std::round(rate)) < 1e-9 * rate) rate = std::round(rate);
    return rate;
  };
  Statement statement{numbers[0], std::nullopt, meaning, shown(line)};
  if (meaning.says == Says::duration) {
    statement.value = numbers[0] * (unit && unit->dimension == firmware::Dimension::time ? unit->scale : 1.0);
    return statement;
  }
  if (meaning.says == Says::count) return statement;
  statement.value = to_rate(numbers[0]);
  if (numbers.size() > 1 && numbers[1] > 0.0) {
    statement.otherwise = to_rate(numbers[1]);
    const auto plausible = [](double rate) { return rate >= slowest_rate && rate <= fastest_rate; };
    if (!plausible(statement.value) && plausible(*statement.otherwise))
      std::swap(statement.value, *statement.otherwise);
  }
  if (!std::isfinite(statement.value) || statement.value < 1e-3 || statement.value > 1e7) return std::nullopt;
  return statement;
}

void collect(std::string_view line, char decimal, std::vector<Statement>& statements) {
  std::string_view text = firmware::trimmed(line);
  while (!text.empty() && (text.front() == '#' || text.front() == '%' || text.front() == '/' || text.front() == '!')) {
    text = firmware::trimmed(text.substr(1));
  }
  if (text.size() > 2000) return;
  const std::vector<std::string_view> parts = parts_of(text);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string_view part = parts[i];
    const std::string_view next = i + 1 < parts.size() ? parts[i + 1] : std::string_view();
    const std::string_view after = i + 2 < parts.size() ? parts[i + 2] : std::string_view();
    std::optional<Statement> found;
    // "key = value", also with a key before it: "Config: data_rate = 2000".
    for (std::size_t mark = part.find_last_of("=:"); mark != std::string_view::npos && mark > 0 && !found;
         mark = part.find_last_of("=:", mark - 1)) {
      found = statement_of(part.substr(0, mark), part.substr(mark + 1), "", line, decimal);
      if (mark == 0) break;
    }
    const std::size_t digit = part.find_first_of("0123456789");
    if (!found && !next.empty()) {
      std::string_view key = part;
      while (key.ends_with(':') || key.ends_with('=')) key = firmware::trimmed(key.substr(0, key.size() - 1));
      found = statement_of(key, next, after, line, decimal);
    }
    if (!found && digit != std::string_view::npos && digit > 0 &&
        part.find_first_of("=:") == std::string_view::npos) {  // "Messrate 500 Hz"
      found = statement_of(part.substr(0, digit), part.substr(digit), next, line, decimal);
    }
    if (found) statements.push_back(std::move(*found));
  }
}

// Rows over a stated duration, where that is a whole rate: "Messzeit: 10 s" above 10 000 rows.
std::optional<StatedRate> rate_of_duration(const std::vector<Statement>& statements, std::size_t samples) {
  std::optional<StatedRate> found;
  for (const Statement& one : statements) {
    if (one.key.says != Says::duration || samples < 2) continue;
    for (const std::size_t steps : {samples, samples - 1}) {
      const double rate = static_cast<double>(steps) / one.value;
      if (std::abs(rate - std::round(rate)) > 1e-6 * rate || rate < slowest_rate || rate > fastest_rate) continue;
      if (found) return std::nullopt;
      found = StatedRate{std::round(rate), one.line, ""};
      break;
    }
  }
  return found;
}

bool agree(double a, double b) { return std::abs(a / b - 1.0) < same_rate; }

}  // namespace

std::optional<StatedRate> find_rate(const std::vector<std::string_view>& preamble, RateHints hints) {
  std::vector<Statement> statements;
  for (const std::string_view line : preamble) collect(line, hints.decimal, statements);
  std::vector<const Statement*> rates;
  std::vector<double> durations;
  std::vector<double> counts;
  if (hints.samples > 0) counts.push_back(static_cast<double>(hints.samples));
  for (const Statement& one : statements) {
    if (one.key.says == Says::duration) durations.push_back(one.value);
    if (one.key.says == Says::count) counts.push_back(one.value);
  }
  // Duration and number of samples, where both are known: within one sample of it.
  const auto confirmed = [&](double rate) {
    for (const double duration : durations) {
      for (const double count : counts) {
        if (std::abs(duration * rate - count) <= std::max(1.5, 1e-3 * count)) return true;
      }
    }
    return false;
  };
  for (const bool of_sampling : {true, false}) {
    for (const Statement& one : statements) {
      if ((one.key.says == Says::rate || one.key.says == Says::interval) && one.key.of_sampling == of_sampling)
        rates.push_back(&one);
    }
    if (!rates.empty()) break;
  }
  if (rates.empty()) return rate_of_duration(statements, hints.samples);
  for (const Statement* one : rates) {
    if (confirmed(one->value)) return StatedRate{one->value, one->line, ""};
    if (one->otherwise && confirmed(*one->otherwise)) return StatedRate{*one->otherwise, one->line, ""};
  }
  StatedRate result{rates[0]->value, rates[0]->line, ""};
  for (const Statement* one : rates) {
    if (!agree(one->value, result.rate) && result.conflict.empty()) result.conflict = one->line;
  }
  return result;
}

}  // namespace host_sim
