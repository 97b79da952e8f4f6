#include "firmware/description/compensation_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/text/spelling.hpp"

namespace firmware {
namespace {

using compensation::Kind;

constexpr std::array<std::string_view, 3> list_keys{"coefficients", "lowest", "highest"};

constexpr auto keys = std::to_array<CompensationKey>({
    {"delay", 0.0, 0.2, "the assumed delay in s", [](compensation::Settings& s) -> double& { return s.machine.delay; }},
    {"lag", 0.0, 0.2, "the assumed time constant in s", [](compensation::Settings& s) -> double& { return s.machine.lag; }},
    {"frequency", 0.0, 1e4, "the assumed natural frequency in Hz",
     [](compensation::Settings& s) -> double& { return s.machine.resonance_frequency; }},
    {"damping_ratio", 0.0, 10.0, "the assumed damping ratio",
     [](compensation::Settings& s) -> double& { return s.machine.resonance_damping; }},
    {"gain", 0.5, 2.0, "x_act/x_cmd of the assumed machine at rest", [](compensation::Settings& s) -> double& { return s.gain; }},
    {"start_ramp", 0.0, 10.0, "a time in s", [](compensation::Settings& s) -> double& { return s.start_ramp; }},
    {"limit", 1e-6, 1.0, "a distance in m", [](compensation::Settings& s) -> double& { return s.limit; }},
    {"force_limit", 1e-3, 1e6, "a force in N", [](compensation::Settings& s) -> double& { return s.force_limit; }},
    {"rate", 1e-3, 100.0, "a speed in m/s", [](compensation::Settings& s) -> double& { return s.rate; }},
    {"force_lead", 0.0, 2.0, "a number of periods", [](compensation::Settings& s) -> double& { return s.force_lead; }},
    {"memory", 0.1, 100.0, "a time in s", [](compensation::Settings& s) -> double& { return s.memory; }},
    {"bandwidth", 0.5, 200.0, "a frequency in Hz", [](compensation::Settings& s) -> double& { return s.bandwidth; }},
    {"quiet", 1e-9, 1e-2, "a distance in m", [](compensation::Settings& s) -> double& { return s.quiet; }},
    {"settling", 1e-3, 100.0, "a time in s", [](compensation::Settings& s) -> double& { return s.settling; }},
    {"feedback_bandwidth", 0.0, 20.0, "a frequency in Hz", [](compensation::Settings& s) -> double& { return s.feedback_bandwidth; }},
    {"damping", 0.0, 1e5, "a damping in N s/m", [](compensation::Settings& s) -> double& { return s.damping; }},
    {"energy_memory", 0.01, 100.0, "a time in s", [](compensation::Settings& s) -> double& { return s.energy_memory; }},
    {"damping_time", 1e-3, 10.0, "a time in s", [](compensation::Settings& s) -> double& { return s.damping_time; }},
});

std::optional<Kind> kind_of(std::string_view name) {
  const auto& names = compensation::kind_names;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Kind>(found - names.begin());
}

compensation::Settings defaults_of(const RigDescription& description, Kind kind) {
  compensation::Settings s;
  s.kind = kind;
  const auto& rig = description.rig;
  rig.effects.act_on(s.machine);
  s.machine.rate_limit = 0.0;
  s.machine.delay += rig.effects.sensor_paths()[model::index(model::Channel::F)].delay +
                     description.delay_budget.sensor_age + description.delay_budget.transport;
  s.component = {.stiffness = rig.suspension.stiffness,
                 .damping = rig.suspension.damping,
                 .has_fdva = rig.has_fdva,
                 .fdva = rig.fdva};
  return s;
}

void finish(const RigDescription& description, compensation::Settings& s) {
  if (s.damping > 0.0) return;
  const auto& rig = description.rig;
  const double stiffness = rig.suspension.stiffness + (rig.has_fdva ? rig.fdva.coupling_stiffness : 0.0);
  const double omega = std::sqrt((rig.tyre.stiffness + stiffness) / rig.wheel.mass);
  const double late = s.delay() + 0.5 * description.period();
  s.damping = std::max(0.0, compensation::damping_against_delay(stiffness, omega, late));
}

compensation::Settings settings_of(const RigDescription& description, Kind kind) {
  compensation::Settings s = defaults_of(description, kind);
  if (const auto description_of_it = compensation_of(description)) {
    const CompensationDescription& given = *description_of_it;
    for (const CompensationKey& key : compensation_keys()) {
      if (const auto found = given.numbers.find(key.key); found != given.numbers.end()) key.value(s) = found->second;
    }
    if (const auto found = given.numbers.find("order"); found != given.numbers.end()) {
      s.order = static_cast<int>(found->second);
    }
    for (const auto& [name, values] : given.lists) {
      auto& target = name == "coefficients" ? s.given : name == "lowest" ? s.lowest : s.highest;
      std::copy_n(values.begin(), std::min(values.size(), target.size()), target.begin());
    }
  }
  finish(description, s);
  return s;
}

}  // namespace

std::span<const CompensationKey> compensation_keys() { return keys; }

std::optional<CompensationDescription> read_compensation(DescriptionTable& top, model::RigKind kind) {
  auto table = top.table("compensation");
  if (!table) return std::nullopt;
  if (kind != model::RigKind::hil) {
    top.fail("compensation", "[compensation] belongs to a hil rig", "kind = \"hil\", or no [compensation]");
  }
  CompensationDescription given;
  given.kind = table->text("kind");
  if (!kind_of(given.kind)) {
    table->fail("kind", with_suggestion("unknown compensation", given.kind, compensation::kind_names),
                "one of " + listed(compensation::kind_names));
  }
  for (const CompensationKey& key : keys) {
    if (!table->has(key.key)) continue;
    double value = 0.0;
    table->number_in(key.key, value, key.lowest, key.highest, key.what);
    given.numbers.emplace(std::string(key.key), value);
  }
  if (table->has("order")) given.numbers.emplace("order", table->whole_in("order", 1, 3));
  for (const std::string_view key : list_keys) {
    if (!table->has(key)) continue;
    const std::string expected = "four numbers a0 … a3, in s^i";
    const toml::node& node = table->need(key, expected);
    std::vector<double> values;
    const auto* list = node.as_array();
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      const auto value = as_number((*list)[i]);
      if (!value || !std::isfinite(*value)) table->fail(node, table->path(key) + " holds no number", expected);
      values.push_back(*value);
    }
    if (values.size() != compensation::coefficients) {
      table->fail(node, table->path(key) + " is no list of four numbers", expected);
    }
    given.lists.emplace(std::string(key), values);
  }
  table->finish();
  return given;
}

std::optional<CompensationDescription> compensation_of(const RigDescription& description) {
  if (description.text.find("compensation") == std::string::npos) return std::nullopt;
  const toml::table all = toml::parse(description.text, description.source);
  DescriptionTable top(all, "", description.source);
  return read_compensation(top, description.rig.kind);
}

std::vector<std::pair<std::string, std::string>> compensation_lines(const RigDescription& description) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto real = [](double value) {
    const std::string text = shortest(value);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  };
  const auto given = compensation_of(description);
  if (!given) return lines;
  lines.emplace_back("kind", "\"" + given->kind + "\"");
  for (const auto& [key, value] : given->numbers) {
    lines.emplace_back(key, key == "order" ? std::to_string(static_cast<int>(value)) : real(value));
  }
  for (const auto& [key, values] : given->lists) {
    std::string list;
    for (const double value : values) list += (list.empty() ? "" : ", ") + real(value);
    lines.emplace_back(key, "[" + list + "]");
  }
  return lines;
}

compensation::Settings compensation_settings(const RigDescription& description, compensation::Kind kind) {
  compensation::Settings s = settings_of(description, kind);
  const auto fail = [&](std::string_view wrong, std::string_view expected) {
    throw InputError(description.source, description.line_of("compensation"), std::string(wrong),
                     std::string(expected));
  };
  if (const auto wrong = s.check(); !wrong.empty()) fail("[compensation] does not fit this rig", wrong);
  if (!compensation::Compensator::fits(s, description.period())) {
    fail("[compensation] " + std::string(name(kind)) + " looks back further than 252 periods",
         "a shorter delay, a lower order, or a lower sample_rate");
  }
  return s;
}

std::optional<compensation::Settings> compensation_settings(const RigDescription& description) {
  const auto given = compensation_of(description);
  if (!given) return std::nullopt;
  return compensation_settings(description, *kind_of(given->kind));
}

std::optional<compensation::Compensator> make_compensator(const RigDescription& description) {
  const auto settings = compensation_settings(description);
  if (!settings) return std::nullopt;
  return compensation::Compensator(*settings, description.period());
}

void refuse_compensation(const RigDescription& description, std::string_view command) {
  if (!compensation_of(description)) return;
  throw InputError(description.source, description.line_of("compensation"),
                   std::string(command) + " computes with a loop without [compensation]",
                   "a description of machine and component alone, kind = \"component_bench\": the columns x_cmd, x_act "
                   "and F of the recording are a bench's");
}

}  // namespace firmware
