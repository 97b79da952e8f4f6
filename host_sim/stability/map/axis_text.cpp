// Ranges of maps and sweeps as a user writes them.
#include <charconv>
#include <cmath>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/spelling.hpp"
#include "host_sim/stability/map/boundary.hpp"
#include "host_sim/stability/map/stability_map.hpp"
#include "host_sim/stability/margins/crossings.hpp"
#include "host_sim/stability/margins/sensitivity.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim::stability {
namespace {

constexpr std::string_view form = "variable=from:to:count, such as tau=0:0.03:200";
constexpr std::size_t most_values = 5000;

double number(std::string_view text, std::string_view whole) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw firmware::UsageError(firmware::in_quotes(whole) + ": " + firmware::in_quotes(text) +
                               " is not a number, expected " + std::string(form));
  }
  return value;
}

}  // namespace

Axis parse_axis(std::string_view text, const model::RigParameters<double>& rig, double period) {
  const std::size_t equals = text.find('=');
  const std::size_t first = equals == text.npos ? text.npos : text.find(':', equals);
  const std::size_t second = first == text.npos ? text.npos : text.find(':', first + 1);
  if (second == text.npos || text.find(':', second + 1) != text.npos) {
    throw firmware::UsageError(firmware::in_quotes(text) + " is not a range, expected " + std::string(form));
  }
  Axis axis;
  axis.variable = text.substr(0, equals);
  axis.from = number(text.substr(equals + 1, first - equals - 1), text);
  axis.to = number(text.substr(first + 1, second - first - 1), text);
  const double count = number(text.substr(second + 1), text);
  const auto fail = [&](const std::string& wrong, const std::string& expected) {
    throw firmware::UsageError(firmware::in_quotes(text) + ": " + wrong + ", expected " + expected);
  };

  model::RigParameters<double> changed = rig;
  const std::string path = axis.variable == "virtual_damping" ? "machine.virtual_damping" : axis.variable;
  if (axis.variable != "tau" && firmware::find_parameter(changed, path) == nullptr) {
    std::vector<std::string> names = real_parameters(rig);
    names.insert(names.begin(), {"tau", "virtual_damping"});
    const std::vector<std::string_view> known(names.begin(), names.end());
    fail("this rig has no variable " + firmware::in_quotes(axis.variable) + " (did you mean " +
             firmware::in_quotes(firmware::nearest(axis.variable, known)) + "?)",
         "tau, virtual_damping or a parameter path of the rig description");
  }
  if (!(axis.from < axis.to)) fail("the range runs backwards or is empty", "from < to");
  if (count != std::floor(count) || count < 2.0 || count > static_cast<double>(most_values)) {
    fail("the count is not a whole number in 2 … " + std::to_string(most_values), std::string(form));
  }
  axis.count = static_cast<std::size_t>(count);
  if (axis.is_delay()) {
    if (axis.from < 0.0 || axis.to > longest_delay) fail("a delay is out of range", "delays from 0 to 1 s");
    return axis;
  }
  for (const double end : {axis.from, axis.to}) {
    *firmware::find_parameter(changed, path) = end;
    if (const auto fault = model::find_fault(changed, period, model::RigModel<>::Line::longest)) {
      fail("no rig has " + path + " = " + std::to_string(end), std::string(fault->expected));
    }
  }
  return axis;
}

std::pair<Axis, Axis> parse_map(std::string_view text, const model::RigParameters<double>& rig, double period) {
  const std::size_t comma = text.find(',');
  if (comma == text.npos || text.find(',', comma + 1) != text.npos) {
    throw firmware::UsageError(firmware::in_quotes(text) +
                               " is not a map, expected two ranges, such as tau=0:0.03:200,virtual_damping=0:2000:200");
  }
  std::pair<Axis, Axis> axes{parse_axis(text.substr(0, comma), rig, period),
                             parse_axis(text.substr(comma + 1), rig, period)};
  model::RigParameters<double> copy = rig;
  const bool same = axes.first.is_delay() ? axes.second.is_delay()
                                          : !axes.second.is_delay() && &parameter_of(copy, axes.first.variable) ==
                                                                           &parameter_of(copy, axes.second.variable);
  if (same)
    throw firmware::UsageError(firmware::in_quotes(text) +
                               ": both ranges are of one variable, expected two different ones");
  return axes;
}

}  // namespace host_sim::stability
