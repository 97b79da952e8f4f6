#include "firmware/description/compensation_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/spelling.hpp"

namespace firmware {
namespace {

using compensation::Kind;
using CompensationSettings = compensation::Settings;

constexpr std::array<std::string_view, 3> list_keys{"coefficients", "lowest", "highest"};

constexpr auto number_keys = std::to_array<CompensationKey>({
    {"delay", 0.0, 0.2, "the assumed delay in s", [](CompensationSettings& s) -> double& { return s.machine.delay; }},
    {"lag", 0.0, 0.2, "the assumed time constant in s",
     [](CompensationSettings& s) -> double& { return s.machine.lag; }},
    {"frequency", 0.0, 1e4, "the assumed natural frequency in Hz",
     [](CompensationSettings& s) -> double& { return s.machine.resonance_frequency; }},
    {"damping_ratio", 0.0, 10.0, "the assumed damping ratio",
     [](CompensationSettings& s) -> double& { return s.machine.resonance_damping; }},
    {"gain", 0.5, 2.0, "x_act/x_cmd of the assumed machine at rest",
     [](CompensationSettings& s) -> double& { return s.gain; }},
    {"start_ramp", 0.0, 10.0, "a time in s", [](CompensationSettings& s) -> double& { return s.start_ramp; }},
    {"limit", 1e-6, 1.0, "a distance in m", [](CompensationSettings& s) -> double& { return s.limit; }},
    {"force_limit", 1e-3, 1e6, "a force in N", [](CompensationSettings& s) -> double& { return s.force_limit; }},
    {"rate", 1e-3, 100.0, "a speed in m/s", [](CompensationSettings& s) -> double& { return s.rate; }},
    {"force_lead", 0.0, 2.0, "a number of periods", [](CompensationSettings& s) -> double& { return s.force_lead; }},
    {"memory", 0.1, 100.0, "a time in s", [](CompensationSettings& s) -> double& { return s.memory; }},
    {"bandwidth", 0.5, 200.0, "a frequency in Hz", [](CompensationSettings& s) -> double& { return s.bandwidth; }},
    {"quiet", 1e-9, 1e-2, "a distance in m", [](CompensationSettings& s) -> double& { return s.quiet; }},
    {"settling", 1e-3, 100.0, "a time in s", [](CompensationSettings& s) -> double& { return s.settling; }},
    {"feedback_bandwidth", 0.0, 20.0, "a frequency in Hz",
     [](CompensationSettings& s) -> double& { return s.feedback_bandwidth; }},
    {"damping", 0.0, 1e5, "a damping in N s/m", [](CompensationSettings& s) -> double& { return s.damping; }},
    {"energy_memory", 0.01, 100.0, "a time in s", [](CompensationSettings& s) -> double& { return s.energy_memory; }},
    {"damping_time", 1e-3, 10.0, "a time in s", [](CompensationSettings& s) -> double& { return s.damping_time; }},
});

Kind read_kind_of_compensation(DescriptionTable& table) {
  const std::string word = table.text("kind");
  const auto& names = compensation::kind_names;
  const auto* const found = std::find(names.begin(), names.end(), word);
  if (found == names.end()) {
    table.fail("kind", with_suggestion("unknown compensation", word, names), "one of " + listed(names));
  }
  return static_cast<Kind>(found - names.begin());
}

std::vector<double> read_coefficients(DescriptionTable& table, std::string_view key) {
  const std::string expected = "four numbers a0 … a3, in s^i";
  const toml::node& node = table.need(key, expected);
  const auto* list = node.as_array();
  if (list == nullptr || list->size() != compensation::coefficients) {
    table.fail(node, table.path(key) + " is no list of four numbers", expected);
  }
  std::vector<double> values;
  for (const toml::node& item : *list) {
    const auto value = as_number(item);
    if (!value || !std::isfinite(*value)) table.fail(item, table.path(key) + " holds no number", expected);
    values.push_back(*value);
  }
  return values;
}

}  // namespace

std::span<const CompensationKey> compensation_keys() { return number_keys; }

std::optional<CompensationDescription> read_compensation(DescriptionTable& top,
                                                         const model::RigParameters<double>& rig) {
  auto table = top.table("compensation");
  if (!table) return std::nullopt;
  if (rig.kind != model::RigKind::hil) {
    top.fail("compensation",
             "[compensation] has no loop to compensate: this is a " + std::string(model::name(rig.kind)),
             "kind = \"hil\", or no [compensation]");
  }
  CompensationDescription given;
  given.kind = read_kind_of_compensation(*table);
  for (const CompensationKey& key : number_keys) {
    if (!table->has(key.key)) continue;
    double value = 0.0;
    table->number_in(key.key, value, key.lowest, key.highest, key.what);
    given.numbers.emplace(std::string(key.key), value);
  }
  if (table->has("order")) given.numbers.emplace("order", table->whole_in("order", 1, 3));
  for (const std::string_view key : list_keys) {
    if (table->has(key)) given.lists.emplace(std::string(key), read_coefficients(*table, key));
  }
  table->finish();
  return given;
}

std::vector<std::pair<std::string, std::string>> compensation_lines(const CompensationDescription& compensation) {
  const auto real = [](double value) {
    const std::string text = shortest(value);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  };
  std::vector<std::pair<std::string, std::string>> lines;
  lines.emplace_back("kind", "\"" + std::string(name(compensation.kind)) + "\"");
  for (const auto& [key, value] : compensation.numbers) {
    lines.emplace_back(key, key == "order" ? std::to_string(static_cast<int>(value)) : real(value));
  }
  for (const auto& [key, values] : compensation.lists) {
    std::string list;
    for (const double value : values) list += (list.empty() ? "" : ", ") + real(value);
    lines.emplace_back(key, "[" + list + "]");
  }
  return lines;
}

}  // namespace firmware
