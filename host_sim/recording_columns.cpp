#include "host_sim/recording_columns.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace host_sim {
namespace {

constexpr std::array<std::string_view, recorded_ducts> duct_names{"duct_1", "duct_2", "duct_3",
                                                                  "duct_4", "duct_5", "duct_6"};

// For a recording that may be changed and for one that may not.
template <class AnyRecording>
auto& column_of(AnyRecording& recording, Quantity quantity) {
  if (quantity == time_quantity) return recording.time;
  return quantity < first_duct ? recording.channels[quantity - 1] : recording.ducts[quantity - first_duct];
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

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
  for (Quantity q = 1; q < first_duct; ++q) list += std::string(name(q)) + ", ";
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

bool all_are_single_precision(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(),
                     [](double x) { return static_cast<double>(static_cast<float>(x)) == x; });
}

double median_step(const std::vector<double>& time) {
  std::vector<double> steps(time.size() - 1);
  for (std::size_t k = 1; k < time.size(); ++k) steps[k - 1] = time[k] - time[k - 1];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// Six digits, for a message: rates and steps as a person would write them.
std::string rounded(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
  return {text.data(), end};
}

// Unit of the last printed place of a stamp as large as `largest` [s].
double last_place(const StampRounding& rounding, double largest) {
  const double in_file = largest / rounding.scale;
  const double by_decimals = std::pow(10.0, -rounding.decimals);
  const double by_digits =
      in_file > 0.0 ? std::pow(10.0, std::floor(std::log10(in_file)) + 1.0 - rounding.significant_digits) : 0.0;
  return std::max(by_decimals, by_digits) * rounding.scale;
}

}  // namespace

const std::vector<double>& Recording::required(model::Channel channel, std::string_view purpose) const {
  if (!has(channel)) {
    throw InputError(source, 0, "there is no channel " + std::string(model::name(channel)),
                     "that channel: it " + std::string(purpose));
  }
  return (*this)[channel];
}

std::string_view name(Quantity quantity) {
  if (quantity == time_quantity) return "t";
  return quantity < first_duct ? model::channel_names[quantity - 1].name : duct_names[quantity - first_duct];
}

std::string_view unit(Quantity quantity) {
  if (quantity == time_quantity) return "s";
  return quantity < first_duct ? model::channel_names[quantity - 1].unit : std::string_view{};
}

std::optional<Quantity> find_quantity(std::string_view wanted) {
  for (Quantity q = 0; q < quantity_count; ++q) {
    if (name(q) == wanted) return q;
  }
  return std::nullopt;
}

const std::vector<double>& values(const Recording& recording, Quantity quantity) {
  return column_of(recording, quantity);
}

std::vector<double>& values(Recording& recording, Quantity quantity) { return column_of(recording, quantity); }

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

  for (const auto& [quantity_name, column] : map) {
    const std::optional<Quantity> q = find_quantity(quantity_name);
    if (!q) continue;
    const std::optional<std::size_t> c = find_column(headings, column.column, source, line);
    if (!c) continue;
    if (targets[*c]) {
      throw InputError(source, line,
                       "column " + in_quotes(column.column) + " is both " + std::string(name(targets[*c]->quantity)) +
                           " and " + std::string(name(*q)) + " in [channels]",
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
    if (headings[c].unit && !is_si_unit(*headings[c].unit, unit(*q))) {
      const std::string_view si = unit(*q).empty() ? "none (1 open, 0 closed)" : unit(*q);
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

std::string age_name(model::Channel channel) { return "age_" + std::string(model::name(channel)); }

Objection object_to(Quantity quantity, double value) {
  if (!std::isfinite(value)) return {std::string(name(quantity)) + " is " + shortest(value), "a finite number"};
  if (quantity >= first_duct && value != 0.0 && value != 1.0) {
    return {std::string(name(quantity)) + " is " + shortest(value), "1 (open) or 0 (closed)"};
  }
  return {};
}

InputError Place::error(std::size_t k, std::string_view wrong, std::string_view expected) const {
  if (first_line > 0) return {source, first_line + k, wrong, expected};
  return {source, 0, "sample " + std::to_string(k + 1) + ": " + std::string(wrong), expected};
}

void check_time_rises(const Recording& recording, const Place& place) {
  const std::vector<double>& time = recording.time;
  for (std::size_t k = 1; k < time.size(); ++k) {
    if (time[k] > time[k - 1]) continue;
    const std::string stamp = shortest(time[k]) + " follows " + shortest(time[k - 1]);
    if (time[k] == time[k - 1]) throw place.error(k, "time stands still: " + stamp, "a later time in each sample");
    throw place.error(k, "time runs backwards: " + stamp, "a later time in each sample");
  }
}

void check_time(Recording& recording, const StampRounding& rounding, const Place& place,
                std::optional<double> expected_rate) {
  const std::vector<double>& time = recording.time;
  const std::size_t n = time.size();
  if (n < 2) throw place.error(0, "there is only one sample", "at least two");
  check_time_rises(recording, place);

  constexpr double jitter = 1e-3;       // of T; these two are explained at read_recording
  constexpr double clock_error = 1e-4;  // of T
  const double largest = std::max(std::abs(time.front()), std::abs(time.back()));
  const double arithmetic = 4.0 * std::numeric_limits<double>::epsilon() * largest;
  // Stamps kept in single precision are as coarse as that; with eight digits or fewer the printing is coarser still.
  const bool single = rounding.significant_digits > 8 && all_are_single_precision(time);
  const double printed = std::max(last_place(rounding, largest),
                                  single ? static_cast<double>(std::numeric_limits<float>::epsilon()) * largest : 0.0);
  const double mean = (time.back() - time.front()) / static_cast<double>(n - 1);
  double period = expected_rate ? 1.0 / *expected_rate : mean;
  if (!expected_rate) {
    const double middle = median_step(time);
    if (std::abs(mean - middle) > printed + jitter * middle) period = middle;  // the mean holds a gap
    const double whole_rate = std::round(1.0 / period);
    const double mean_error = (printed + arithmetic) / static_cast<double>(n - 1) + 1e-9 * period;
    if (whole_rate >= 1.0 && std::abs(1.0 / whole_rate - period) <= std::min(mean_error, jitter * period)) {
      period = 1.0 / whole_rate;
    }
  }
  recording.sample_period = period;

  const double places = period / printed;
  const bool exact = !single && std::abs(places - std::round(places)) < 1e-3 && places > 0.5;
  const double stamp_error = (exact ? 0.0 : printed) + arithmetic;
  const double tolerance = stamp_error + jitter * period;

  std::size_t odd = 1;
  while (odd < n && std::abs(time[odd] - time[odd - 1] - period) <= tolerance) ++odd;
  const auto rate_error = [&](std::size_t k, double step) {
    return place.error(k, "the recording's rate is " + rounded(1.0 / step) + " Hz (steps of " + rounded(step) + " s)",
                       rounded(1.0 / period) + " Hz as in the rig description");
  };
  if (odd < n) {
    const double middle = median_step(time);
    if (expected_rate && std::abs(middle - period) > tolerance) throw rate_error(1, middle);
    const double step = time[odd] - time[odd - 1];
    throw place.error(odd,
                      (step > period ? "gap in time: " : "irregular time: ") + shortest(time[odd]) + " follows " +
                          shortest(time[odd - 1]),
                      "steps of " + rounded(period) + " s ± " + rounded(tolerance) + " s");
  }
  if (stamp_error > 0.5 * period) {
    throw place.error(1, "time is rounded to " + rounded(stamp_error) + " s",
                      "stamps that tell a gap from a step of " + rounded(period) + " s");
  }
  if (std::abs(mean - period) >
      clock_error * period + (stamp_error + 2.0 * jitter * period) / static_cast<double>(n - 1)) {
    throw rate_error(1, mean);
  }
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::vector<double> sample_times(std::size_t count, double rate, std::size_t first) {
  std::vector<double> times(count);
  for (std::size_t k = 0; k < count; ++k) times[k] = static_cast<double>(first + k) / rate;
  return times;
}

bool is_recorded_quantity(std::string_view name) { return find_quantity(name).has_value(); }

}  // namespace host_sim
