#include "firmware/description/values/extensions.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware/description/text/number_text.hpp"
#include "model/components/air_spring.hpp"
#include "model/rig/lever_at_rest.hpp"

namespace firmware {
namespace {

using Air = model::AirSpringParameters<double, true>;
using Rig = model::RigParameters<double>;

constexpr std::array<AirSpringKey, 16> keys{{
    {"area_per_stroke", &Air::area_per_stroke, true, "m"},
    {"volume_per_area", &Air::volume_per_area, true, "m³"},
    {"polytropic_exponent", &Air::polytropic_exponent, true, "1"},
    {"heat_time", &Air::heat_time, true, "s"},
    {"counter_pressure", &Air::counter_pressure, true, "Pa"},
    {"counter_area", &Air::counter_area, true, "m²"},
    {"counter_volume", &Air::counter_volume, true, "m³"},
    {"actuator_frequency", &Air::actuator_frequency, true, "Hz"},
    {"ambient_pressure", &Air::ambient_pressure, false, "Pa"},
    {"actuator_damping", &Air::actuator_damping, false, "1"},
    {"actuator_rate", &Air::actuator_rate, false, "1/s"},
    {"actuator_stroke", &Air::actuator_stroke, false, "1"},
    {"skyhook", &Air::skyhook, false, "N s/m"},
    {"levelling_rate", &Air::levelling_rate, false, "1/s"},
    {"levelling_band", &Air::levelling_band, false, "m"},
    {"levelling_time", &Air::levelling_time, false, "s"},
}};

/// Of a body that rests on its air spring alone, load and weight may differ by this share: 5 % is the tolerance of a
/// pressure gauge and of a bellows' area. Half: descriptions rounded to two digits are refused. Twice: a body that
/// would sink by a tenth of its static deflection passes.
constexpr double load_error = 0.05;
constexpr double gravity = 9.81;  ///< [m/s²]

std::vector<double> numbers(DescriptionTable& table, std::string_view key, std::string_view expected) {
  const toml::node& node = table.need(key, expected);
  std::vector<double> values;
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& element : *array) {
      const auto value = as_number(element);
      if (!value || !std::isfinite(*value))
        table.fail(element, "a value of " + table.path(key) + " is no number", expected);
      values.push_back(*value);
    }
  }
  if (values.size() < 2 || values.size() > model::lever_points) {
    table.fail(node, table.path(key) + " does not fit", expected);
  }
  return values;
}

}  // namespace

std::span<const AirSpringKey> air_spring_keys() { return keys; }

void read_air_spring(DescriptionTable& top, Rig& rig) {
  auto table = top.table("air_spring");
  if (!table) return;
  rig.air_spring.fitted = true;
  rig.air_spring.pressure = table->number("pressure");
  rig.air_spring.area = table->number("area");
  rig.air_spring.volume = table->number("volume");
  for (const AirSpringKey& key : air_spring_keys()) table->optional_number(key.key, rig.air_spring.*key.value);
  if (rig.kind == model::RigKind::component_bench && rig.air_spring.skyhook != 0.0) {
    table->fail("skyhook", "air_spring.skyhook = " + shortest(rig.air_spring.skyhook) + " does not fit",
                "0: a component_bench has no body");
  }
  table->finish();
}

void read_lever(DescriptionTable& top, Rig& rig) {
  auto table = top.table("lever");
  if (!table) return;
  const auto at = numbers(*table, "at", "2 to 9 ascending suspension deflections z_w − z_b in m");
  const auto ratio = numbers(*table, "ratio", "as many lever ratios as there are numbers in at, each 0.1 to 10");
  if (at.size() != ratio.size()) {
    table->fail(
        "ratio",
        "lever.ratio has " + std::to_string(ratio.size()) + " numbers and lever.at " + std::to_string(at.size()),
        "one ratio for each deflection");
  }
  rig.lever.count = static_cast<std::uint8_t>(at.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    rig.lever.at[i] = at[i];
    rig.lever.ratio[i] = ratio[i];
  }
  table->finish();
}

void read_delay_variation(DescriptionTable& machine, Rig& rig) {
  machine.optional_number("delay_swing", rig.delay_variation.swing);
  machine.optional_number("delay_swing_time", rig.delay_variation.time);
  machine.optional_number("delay_jitter", rig.delay_variation.jitter);
}

void check_load(DescriptionTable& top, const Rig& rig) {
  if (!rig.air_spring.fitted || rig.suspension.stiffness > 0.0) return;
  const bool carries_a_body = rig.kind == model::RigKind::quarter_car || rig.kind == model::RigKind::hil;
  if (!carries_a_body) return;  // a mass that a force drives may lie on its side
  const double ratio = model::lever_at_rest(rig).ratio;
  const double load = model::AirSpring<double>::load(rig.air_spring), weight = rig.body.mass * gravity;
  const double needed = weight / ratio;
  if (std::abs(load - needed) <= load_error * needed) return;
  const std::string behind = rig.lever.any() ? ", which is " + shortest(std::round(needed)) +
                                                   " N behind the lever's ratio " + shortest(ratio) + " at rest"
                                             : std::string();
  top.fail("air_spring",
           "air_spring carries " + shortest(std::round(load)) + " N (pressure times area), the body weighs " +
               shortest(std::round(weight)) + " N" + behind,
           "equal forces within 5 %, or a [suspension] stiffness that helps");
}

void check_lever_tolerances(DescriptionTable& top, const Rig& rig, const std::map<std::string, double>& tolerance) {
  if (!rig.lever.any() || rig.kind != model::RigKind::hil) return;
  for (const auto& [path, bound] : tolerance) {
    for (const std::string_view table : {"body.", "wheel.", "tyre.", "machine."}) {
      if (bound > 0.0 && path.starts_with(table)) {
        top.fail("tolerance", "the virtual car's " + path + " has a tolerance beside [lever]",
                 "an exact car: behind a lever it cannot be estimated from F");
      }
    }
  }
}

std::vector<TableLine> extension_lines(const Rig& rig) {
  std::vector<TableLine> lines;
  if (rig.air_spring.fitted) {
    for (const AirSpringKey& key : air_spring_keys()) {
      if (!key.tolerable) lines.push_back({"air_spring", std::string(key.key), shortest(rig.air_spring.*key.value)});
    }
  }
  if (rig.lever.any()) {
    for (const auto& [key, values] : {std::pair("at", rig.lever.at), std::pair("ratio", rig.lever.ratio)}) {
      std::string text = "[";
      for (std::size_t i = 0; i < rig.lever.count; ++i) text += (i == 0 ? "" : ", ") + shortest(values[i]);
      lines.push_back({"lever", key, text + "]"});
    }
  }
  if (rig.delay_variation.any()) {
    lines.push_back({"machine", "delay_swing", shortest(rig.delay_variation.swing)});
    lines.push_back({"machine", "delay_swing_time", shortest(rig.delay_variation.time)});
    lines.push_back({"machine", "delay_jitter", shortest(rig.delay_variation.jitter)});
  }
  return lines;
}

}  // namespace firmware
