#include "host_sim/rig_description.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "firmware/valve_plan.hpp"
#include "host_sim/input_error.hpp"
#include "host_sim/recording_columns.hpp"
#include "host_sim/road.hpp"
#include "model/rig_model.hpp"

namespace host_sim {
namespace {

using Rig = model::RigParameters<double>;

constexpr std::array<ParameterPath, 14> paths{{
    {"body", "mass", "kg", [](Rig& r) -> double& { return r.body.mass; }},
    {"wheel", "mass", "kg", [](Rig& r) -> double& { return r.wheel.mass; }},
    {"tyre", "stiffness", "N/m", [](Rig& r) -> double& { return r.tyre.stiffness; }},
    {"tyre", "damping", "N s/m", [](Rig& r) -> double& { return r.tyre.damping; }},
    {"suspension", "stiffness", "N/m", [](Rig& r) -> double& { return r.suspension.stiffness; }},
    {"suspension", "damping", "N s/m", [](Rig& r) -> double& { return r.suspension.damping; }},
    {"machine", "virtual_damping", "N s/m", [](Rig& r) -> double& { return r.machine.virtual_damping; }},
    {"fdva", "piston_area", "m²", [](Rig& r) -> double& { return r.fdva.piston_area; }},
    {"fdva", "duct_diameter", "m", [](Rig& r) -> double& { return r.fdva.duct_diameter; }},
    {"fdva", "duct_length", "m", [](Rig& r) -> double& { return r.fdva.duct_length; }},
    {"fdva", "oil_density", "kg/m³", [](Rig& r) -> double& { return r.fdva.oil_density; }},
    {"fdva", "oil_viscosity", "m²/s", [](Rig& r) -> double& { return r.fdva.oil_viscosity; }},
    {"fdva", "minor_loss", "1", [](Rig& r) -> double& { return r.fdva.minor_loss; }},
    {"fdva", "coupling_stiffness", "N/m", [](Rig& r) -> double& { return r.fdva.coupling_stiffness; }},
}};

/// "unknown key 'x' (did you mean 'y'?)" for a word that is not among the known ones.
std::string with_suggestion(std::string_view what, std::string_view word, std::span<const std::string_view> known) {
  return std::string(what) + " " + in_quotes(word) + " (did you mean " + in_quotes(nearest(word, known)) + "?)";
}

/// Levenshtein distance: fewest insertions, deletions and substitutions that make one word the other.
std::size_t changes(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);  // of the table, one row at a time
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t changed = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string listed(std::span<const std::string_view> words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

/// Only integers and reals are numbers: toml++ by itself would take `true` for 1.
std::optional<double> as_number(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return static_cast<double>(whole->get());
  if (const auto* real = node.as_floating_point()) return real->get();
  return std::nullopt;
}

std::optional<std::int64_t> as_whole(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return whole->get();
  return std::nullopt;
}

/// The parts that a rig has, by the tables that describe them.
bool has_part(const Rig& rig, std::string_view table) {
  if (table == "fdva") return rig.has_fdva;
  if (table == "machine") return rig.kind == model::RigKind::hil;
  return table == "suspension" || rig.kind != model::RigKind::component_bench;
}

/// A table that knows where it stands and which of its keys have been asked for.
class Reader {
 public:
  Reader(const toml::table& table, std::string name, std::string_view source)
      : table_(&table), name_(std::move(name)), source_(source) {}

  [[nodiscard]] bool has(std::string_view key) {
    known_.insert(std::string(key));
    return table_->contains(key);
  }

  void optional_number(std::string_view key, double& value) {
    if (has(key)) value = number(key);
  }

  double number(std::string_view key) {
    const toml::node& node = need(key, "a number");
    const std::optional<double> value = as_number(node);
    if (!value) fail(node, path(key) + " is not a number", "a number in SI units, such as 1140.0");
    if (!std::isfinite(*value)) fail(node, path(key) + " is not finite", "a finite number in SI units");
    return *value;
  }

  double positive(std::string_view key) {
    const double value = number(key);
    if (!(value > 0.0)) fail(key, path(key) + " = " + shortest(value) + " does not fit", "a number > 0 in SI units");
    return value;
  }

  double not_negative(std::string_view key) {
    const double value = number(key);
    if (!(value >= 0.0)) fail(key, path(key) + " = " + shortest(value) + " does not fit", "a number >= 0 in SI units");
    return value;
  }

  /// A whole number within bounds.
  int whole_in(std::string_view key, int lowest, int highest) {
    const auto value = as_whole(need(key, "a whole number"));
    if (!value || *value < lowest || *value > highest) {
      fail(key, path(key) + " is no such whole number", std::to_string(lowest) + " to " + std::to_string(highest));
    }
    return static_cast<int>(*value);
  }

  bool truth(std::string_view key) {
    const toml::node& node = need(key, "true or false");
    if (!node.is_boolean()) fail(node, path(key) + " is neither true nor false", "true or false");
    return node.as_boolean()->get();
  }

  int whole(std::string_view key) {
    const toml::node& node = need(key, "a whole number");
    const std::optional<std::int64_t> value = as_whole(node);
    if (!value || *value < -1000 || *value > 1000) {
      fail(node, path(key) + " is not a small whole number", "a whole number, such as 2");
    }
    return static_cast<int>(*value);
  }

  std::string text(std::string_view key) {
    const toml::node& node = need(key, "a text in quotes");
    if (!node.is_string()) fail(node, path(key) + " is not a text", "a text in quotes");
    return *node.value<std::string>();
  }

  /// The sub-table, or nothing.
  std::optional<Reader> table(std::string_view key) {
    if (!has(key)) return std::nullopt;
    const toml::node& node = *table_->get(key);
    if (!node.is_table()) fail(node, path(key) + " is not a table", "a table [" + path(key) + "]");
    return Reader(*node.as_table(), path(key), source_);
  }

  const toml::node& need(std::string_view key, std::string_view expected) {
    if (!has(key)) {
      suspect_misspelling(key);
      throw InputError(source_, line(),
                       name_.empty() ? "no " + in_quotes(key) : "[" + name_ + "] has no " + in_quotes(key), expected);
    }
    return *table_->get(key);
  }

  /// Every key that nobody asked for is unknown.
  void finish() const {
    std::vector<std::string_view> known(known_.begin(), known_.end());
    for (const auto& [key, node] : *table_) {
      if (known_.contains(key.str())) continue;
      if (known.empty()) {
        throw InputError(source_, key.source().begin.line, "unknown key " + in_quotes(path(key.str())),
                         "an empty table");
      }
      throw InputError(source_, key.source().begin.line, with_suggestion("unknown key", path(key.str()), full(known)),
                       "one of " + listed(known));
    }
  }

  [[noreturn]] void fail(const toml::node& node, std::string_view wrong, std::string_view expected) const {
    throw InputError(source_, node.source().begin.line, wrong, expected);
  }
  [[noreturn]] void fail(std::string_view key, std::string_view wrong, std::string_view expected) const {
    const toml::node* node = table_->get(key);
    throw InputError(source_, node != nullptr ? node->source().begin.line : line(), wrong, expected);
  }

  [[nodiscard]] const std::string& source() const { return source_; }
  [[nodiscard]] std::size_t line() const { return table_->source().begin.line; }
  [[nodiscard]] const toml::table& raw() const { return *table_; }
  [[nodiscard]] std::string path(std::string_view key) const {
    return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
  }
  void accept_all_keys() {
    for (const auto& [key, node] : *table_) known_.insert(std::string(key.str()));
  }

 private:
  /// A key that is nearly the one missing is the mistake, and its line the place to look at.
  void suspect_misspelling(std::string_view missing) const {
    const std::size_t few = std::max<std::size_t>(1, missing.size() / 3);
    for (const auto& [key, node] : *table_) {
      if (known_.contains(key.str()) || changes(key.str(), missing) > few) continue;
      const std::array<std::string, 1> meant{path(missing)};
      const std::array<std::string_view, 1> words{meant[0]};
      throw InputError(source_, key.source().begin.line, with_suggestion("unknown key", path(key.str()), words),
                       words[0]);
    }
  }

  [[nodiscard]] std::vector<std::string_view> full(std::span<const std::string_view> known) const {
    full_.clear();
    for (const auto& key : known) full_.push_back(path(key));
    return {full_.begin(), full_.end()};
  }

  const toml::table* table_;
  std::string name_;
  std::string source_;
  std::set<std::string, std::less<>> known_;
  mutable std::vector<std::string> full_;
};

model::RigKind read_kind(Reader& top) {
  const std::string word = top.text("kind");
  for (std::size_t i = 0; i < model::rig_kind_names.size(); ++i) {
    if (model::rig_kind_names[i] == word) return static_cast<model::RigKind>(i);
  }
  top.fail("kind", with_suggestion("unknown kind", word, model::rig_kind_names),
           "one of " + listed(model::rig_kind_names));
}

/// All tables of numbers. A component_bench may say on which car (body, wheel, tyre) its component drives:
/// excitation().
void read_parameters(Reader& top, Rig& rig) {
  const bool car = rig.kind != model::RigKind::component_bench;
  struct Part {
    std::string_view table;
    bool needed;
    std::string_view expected;
  };
  const std::array<Part, 6> parts{{
      {"body", car, "a table [body] with mass, which this kind of rig has"},
      {"wheel", car, "a table [wheel] with mass, which this kind of rig has"},
      {"tyre", car, "a table [tyre] with stiffness and damping, which this kind of rig has"},
      {"suspension", true, "a table [suspension] with stiffness and damping"},
      {"machine", false, ""},
      {"fdva", false, ""},
  }};
  for (const Part& part : parts) {
    auto table = top.table(part.table);
    if (!table) {
      if (part.needed) top.need(part.table, part.expected);
      continue;
    }
    for (const auto& p : paths) {
      if (p.table != part.table) continue;
      if (p.table == "machine") {
        table->optional_number(p.key, p.value(rig));
      } else {
        p.value(rig) = table->number(p.key);
      }
    }
    if (part.table == "fdva") {
      rig.has_fdva = true;
      rig.fdva.ducts = table->whole("ducts");
      rig.fdva.open_ducts = table->whole("open_ducts");
    }
    table->finish();
  }
}

template <class Use>
void for_each_channel(Reader& table, const Use& use) {
  std::array<std::string_view, model::channel_count> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = model::channel_names[i].name;
  for (const auto& [key, node] : table.raw()) {
    const auto channel = model::find_channel(key.str());
    if (!channel) {
      table.fail(node, with_suggestion("unknown channel", table.path(key.str()), names), "one of " + listed(names));
    }
    use(*channel, std::string(key.str()), node);
  }
  table.accept_all_keys();
}

template <class Slot>
void read_effect(Reader& parent, std::string_view name, Slot& slot) {
  using Effect = std::remove_cvref_t<decltype(slot.effect)>;
  auto table = parent.table(name);
  if (!table) return;
  slot.active = true;
  for (std::size_t i = 0; i < Effect::card.parameters.size(); ++i) {
    slot.effect.*Effect::values[i] = table->number(Effect::card.parameters[i].name);
  }
  table->finish();
}

void read_effects(Reader& top, Rig& rig) {
  auto effects = top.table("effects");
  if (!effects) return;
  rig.effects.for_each(
      [&](auto& slot) { read_effect(*effects, std::remove_cvref_t<decltype(slot.effect)>::card.name, slot); });
  // A sensor effect has one table for each channel, [effects.sensor_lag.dz_b].
  rig.effects.for_each_sensor([&](auto& slot, model::Channel channel) {
    auto channels = effects->table(std::remove_cvref_t<decltype(slot.effect)>::card.name);
    if (!channels) return;
    for_each_channel(*channels, [](model::Channel, const std::string&, const toml::node&) {});
    read_effect(*channels, model::name(channel), slot);
  });
  effects->finish();
}

void read_tolerances(Reader& top, RigDescription& description) {
  const auto table = top.table("tolerance");
  if (!table) return;
  std::vector<std::string> known;
  for (const auto& p : paths) {
    if (has_part(description.rig, p.table)) known.push_back(std::string(p.table) + "." + std::string(p.key));
  }

  const auto take = [&](const std::string& path, const toml::node& node) {
    if (find_parameter(description.rig, path) == nullptr) {
      const std::vector<std::string_view> words(known.begin(), known.end());
      table->fail(node, with_suggestion("tolerance of the unknown parameter", path, words),
                  "a parameter of this rig, such as \"suspension.stiffness\"");
    }
    const auto value = as_number(node);
    if (!value || !(*value >= 0.0 && *value <= 10.0)) {
      table->fail(node, "the tolerance of " + path + " is not a number in 0 … 10",
                  "a relative bound, such as 0.03 for ±3 %");
    }
    description.tolerance[path] = *value;
  };
  const auto walk = [&](const auto& self, const toml::table& inner, const std::string& prefix) -> void {
    for (const auto& [key, node] : inner) {
      const std::string path = prefix + std::string(key.str());
      if (node.is_table()) {
        self(self, *node.as_table(), path + ".");
      } else {
        take(path, node);
      }
    }
  };
  walk(walk, table->raw(), "");
}

void read_sensors(Reader& top, RigDescription& description) {
  if (auto noise = top.table("noise")) {
    for_each_channel(*noise, [&](model::Channel channel, const std::string& key, const toml::node& node) {
      const double value = noise->number(key);
      if (value < 0.0) noise->fail(node, noise->path(key) + " is negative", "the rms of the channel's noise, >= 0");
      description.noise[model::index(channel)] = value;
    });
  }
  if (auto range = top.table("range")) {
    for_each_channel(*range, [&](model::Channel channel, const std::string& key, const toml::node& node) {
      const auto* pair = node.as_array();
      const bool two = pair != nullptr && pair->size() == 2;
      const auto lowest = two ? as_number((*pair)[0]) : std::nullopt;
      const auto highest = two ? as_number((*pair)[1]) : std::nullopt;
      if (!lowest || !highest || !(*lowest < *highest)) {
        range->fail(node, range->path(key) + " is not a range", "[lowest, highest] in SI units");
      }
      description.range[model::index(channel)] = {*lowest, *highest};
    });
  }
  if (auto channels = top.table("channels")) {
    for (const auto& [key, node] : channels->raw()) {
      const std::string name(key.str());
      if (!is_recorded_quantity(name)) {
        std::vector<std::string_view> names{"t"};
        for (const auto& n : model::channel_names) names.push_back(n.name);
        channels->fail(node, with_suggestion("unknown channel", channels->path(name), names),
                       "t, a channel or duct_1 … duct_6");
      }
      Reader entry = *channels->table(name);
      ColumnSource column;
      column.column = entry.text("column");
      entry.optional_number("scale", column.scale);
      entry.optional_number("offset", column.offset);
      if (column.scale == 0.0) entry.fail("scale", entry.path("scale") + " is 0", "a factor other than 0");
      entry.finish();
      description.channels[name] = column;
    }
    channels->accept_all_keys();
  }
}

model::OpenDucts read_ducts(Reader& table, std::string_view key, int installed) {
  const toml::node& node = table.need(key, "a number of open ducts, or a list of them such as [1, 3]");
  const std::string expected = "a number of open ducts from 0 to " + std::to_string(installed) + ", or a list of them";
  if (node.is_array()) {
    model::OpenDucts open = 0;
    for (const auto& item : *node.as_array()) {
      const auto duct = as_whole(item);
      if (!duct || *duct < 1 || *duct > installed) table.fail(node, table.path(key) + " names no such duct", expected);
      open = static_cast<model::OpenDucts>(open | (1U << static_cast<unsigned>(*duct - 1)));
    }
    return open;
  }
  const auto n = as_whole(node);
  if (!n || *n < 0 || *n > installed) table.fail(node, table.path(key) + " is no such number of ducts", expected);
  return model::first_ducts(static_cast<int>(*n));
}

void read_controller(Reader& top, const Rig& rig, ControllerDescription& controller) {
  if (auto limits = top.table("limits")) {
    if (limits->has("stroke")) controller.stroke = limits->positive("stroke");
    if (limits->has("speed")) controller.speed = limits->positive("speed");
    if (limits->has("force")) controller.force = limits->positive("force");
    if (limits->has("ramp")) controller.ramp = limits->positive("ramp");
    if (limits->has("energy_gain")) controller.energy_gain = limits->positive("energy_gain");
    if (controller.ramp > controller.speed) {
      limits->fail(limits->has("ramp") ? "ramp" : "speed", "limits.ramp is faster than limits.speed",
                   "a ramp of at most " + shortest(controller.speed) + " m/s");
    }
    limits->finish();
  }
  if (auto estimator = top.table("estimator")) {
    if (estimator->has("cross_over")) controller.cross_over = estimator->positive("cross_over");
    estimator->finish();
  }
  auto valves = top.table("valves");
  if (!valves) return;
  const int installed = rig.has_fdva ? rig.fdva.ducts : 0;
  if (valves->has("safe")) controller.safe_ducts = read_ducts(*valves, "safe", installed);
  if (valves->has("plan")) {
    const toml::node& node = valves->need("plan", "");
    const std::string expected = "a list of { t = seconds, open = ducts } with t >= 0 growing";
    const auto* list = node.as_array();
    if (list == nullptr) valves->fail(node, "valves.plan is not a list", expected);
    for (const auto& item : *list) {
      if (!item.is_table()) valves->fail(item, "an entry of valves.plan is not a table", expected);
      Reader entry(*item.as_table(), "valves.plan", valves->source());
      const double t = entry.number("t");
      if (t < 0.0 || (!controller.valve_plan.empty() && t <= controller.valve_plan.back().time)) {
        valves->fail(item, "the times of valves.plan do not grow", expected);
      }
      if (controller.valve_plan.size() == firmware::ValvePlan::capacity) {
        valves->fail(item, "valves.plan is too long",
                     "at most " + std::to_string(firmware::ValvePlan::capacity) + " entries");
      }
      controller.valve_plan.push_back({t, read_ducts(entry, "open", installed)});
      entry.finish();
    }
  }
  valves->finish();
}

void read_delay_budget(Reader& top, model::RigKind kind, DelayBudget& budget) {
  auto table = top.table("delay_budget");
  if (!table) return;
  if (kind != model::RigKind::hil) {
    top.fail("delay_budget", "[delay_budget] does not fit", "none: only the loop of a hil rig has such a budget");
  }
  for (const auto& [key, part] :
       {std::pair("sensor_age", &DelayBudget::sensor_age), std::pair("transport", &DelayBudget::transport),
        std::pair("computation", &DelayBudget::computation)}) {
    if (!table->has(key)) continue;
    const double value = table->number(key);
    if (!(value >= 0.0 && value <= 0.5)) table->fail(key, table->path(key) + " does not fit", "a delay of 0 … 0.5 s");
    budget.*part = value;
  }
  table->finish();
}

void read_gpio(Reader& table, const Rig& rig, GpioDescription& gpio) {
  gpio.chip = table.text("chip");
  if (table.has("valves")) {
    const toml::node& node = table.need("valves", "");
    const int installed = rig.has_fdva ? rig.fdva.ducts : 0;
    const std::string expected = "a list of " + std::to_string(installed) + " line names, one for each duct";
    const auto* list = node.as_array();
    if (list == nullptr) table.fail(node, "gpio.valves is not a list", expected);
    for (const auto& item : *list) {
      if (!item.is_string()) table.fail(item, "a line of gpio.valves is not a text", expected);
      gpio.valves.push_back(item.as_string()->get());
    }
    if (static_cast<int>(gpio.valves.size()) != installed) {
      table.fail(node, "gpio.valves names " + std::to_string(gpio.valves.size()) + " lines", expected);
    }
  }
  if (table.has("valves_active_low")) gpio.valves_active_low = table.truth("valves_active_low");
  if (table.has("stop")) gpio.stop = table.text("stop");
  if (table.has("stop_active_low")) gpio.stop_active_low = table.truth("stop_active_low");
  if (table.has("stop_bias")) {
    gpio.stop_bias = table.text("stop_bias");
    if (gpio.stop_bias != "pull-up" && gpio.stop_bias != "pull-down") {
      table.fail("stop_bias", "unknown gpio.stop_bias " + in_quotes(gpio.stop_bias), "'pull-up' or 'pull-down'");
    }
  }
  if (table.has("heartbeat")) gpio.heartbeat = table.text("heartbeat");
  table.finish();
}

double factor(Reader& table, std::string_view key) {
  const double value = table.number(key);
  if (value == 0.0) table.fail(key, table.path(key) + " is 0", "a factor other than 0");
  return value;
}

/// A sub-table for each channel that is named; other keys are for somebody else.
template <class Use>
void for_each_named_channel(Reader& table, const Use& use) {
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (auto entry = table.table(model::channel_names[i].name)) {
      use(i, *entry);
      entry->finish();
    }
  }
}

void read_converters(Reader& table, ConverterDescription& converters) {
  if (table.has("trigger")) converters.trigger = table.text("trigger");
  if (table.has("trigger_rate")) converters.trigger_rate = table.positive("trigger_rate");
  for_each_named_channel(table, [&](std::size_t channel, Reader& entry) {
    ConverterDescription::Input input{channel, entry.text("device"), entry.text("input")};
    input.scale = factor(entry, "scale");
    entry.optional_number("offset", input.offset);
    converters.inputs.push_back(std::move(input));
  });
  if (auto entry = table.table("command")) {
    ConverterDescription::Output output{entry->text("device"), entry->text("output")};
    output.scale = factor(*entry, "scale");
    entry->optional_number("offset", output.offset);
    constexpr int most = 1 << 24;
    if (entry->has("lowest_counts")) output.lowest_counts = entry->whole_in("lowest_counts", -most, most);
    if (entry->has("highest_counts")) output.highest_counts = entry->whole_in("highest_counts", -most, most);
    if (output.lowest_counts >= output.highest_counts) {
      throw InputError(table.source(), entry->line(), "converters.command has no counts between lowest and highest",
                       "lowest_counts < highest_counts");
    }
    entry->finish();
    converters.command = std::move(output);
  }
  table.finish();
}

void read_hardware(Reader& top, const Rig& rig, HardwareDescription& hardware) {
  if (auto controller = top.table("controller")) {
    ScheduleDescription& schedule = hardware.schedule;
    if (controller->has("priority")) schedule.priority = controller->whole_in("priority", 1, 99);
    if (controller->has("cpu")) schedule.cpu = controller->whole_in("cpu", 0, 1023);
    if (controller->has("late_in_a_row")) schedule.late_in_a_row = controller->whole_in("late_in_a_row", 1, 1000000);
    if (controller->has("wake_early")) schedule.wake_early = controller->not_negative("wake_early");
    if (controller->has("allowed_delay")) schedule.allowed_delay = controller->positive("allowed_delay");
    controller->finish();
  }
  if (auto gpio = top.table("gpio")) read_gpio(*gpio, rig, hardware.gpio.emplace());
  if (auto converters = top.table("converters")) read_converters(*converters, hardware.converters.emplace());
  if (auto lasers = top.table("lasers")) {
    for_each_named_channel(*lasers, [&](std::size_t channel, Reader& entry) {
      LaserDescription laser{channel, entry.text("port")};
      if (entry.has("baud")) laser.baud = entry.whole_in("baud", 2400, 921600);
      if (entry.has("address")) laser.address = entry.whole_in("address", 1, 127);
      laser.range = entry.positive("range");
      if (entry.has("scale")) laser.scale = factor(entry, "scale");
      entry.optional_number("offset", laser.offset);
      hardware.lasers.push_back(std::move(laser));
    });
    lasers->finish();
  }
}

/// A rig that the model refuses, at the line where the number stands.
void check_physics(const toml::table& top, const RigDescription& description) {
  Rig rig = description.rig;
  const bool drives_on_car = rig.kind == model::RigKind::component_bench &&
                             (top.contains("body") || top.contains("wheel") || top.contains("tyre"));
  auto fault = find_rig_fault(rig, description.period());
  if (!fault && drives_on_car) fault = find_rig_fault(on_its_car(rig), description.period());
  if (!fault) return;
  const toml::node* node = &top;
  std::string path;
  const auto descend = [&](std::string_view key) {
    if (key.empty()) return;
    path += (path.empty() ? "" : ".") + std::string(key);
    const toml::table* table = node->as_table();
    const toml::node* inner = table != nullptr ? table->get(key) : nullptr;
    if (inner != nullptr) node = inner;
  };
  if (!fault->table.empty() && !top.contains(fault->table)) descend("effects");
  descend(fault->table);
  if (fault->channel) descend(model::name(*fault->channel));
  descend(fault->key);
  if (path.empty()) path = "the rig as a whole";
  if (const auto value = as_number(*node)) path += " = " + shortest(*value);
  std::string expected(fault->expected);
  if (fault->bounds) expected += ", " + shortest(fault->bounds->lower) + " to " + shortest(fault->bounds->upper);
  throw InputError(description.source, node == &top ? 0 : node->source().begin.line, path + " does not fit", expected);
}

}  // namespace

std::span<const ParameterPath> parameter_paths() { return paths; }

double* find_parameter(model::RigParameters<double>& rig, std::string_view path) {
  for (const auto& p : paths) {
    if (path.size() == p.table.size() + 1 + p.key.size() && path.starts_with(p.table) && path.ends_with(p.key) &&
        path[p.table.size()] == '.') {
      return has_part(rig, p.table) ? &p.value(rig) : nullptr;
    }
  }
  double* found = nullptr;
  const auto look = [&](auto& slot, const std::string& table) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    if (!slot.active) return;
    for (std::size_t i = 0; i < Effect::card.parameters.size(); ++i) {
      if (table + "." + std::string(Effect::card.parameters[i].name) == path) found = &(slot.effect.*Effect::values[i]);
    }
  };
  rig.effects.for_each(
      [&](auto& slot) { look(slot, "effects." + std::string(std::remove_cvref_t<decltype(slot.effect)>::card.name)); });
  rig.effects.for_each_sensor([&](auto& slot, model::Channel channel) {
    look(slot, "effects." + std::string(std::remove_cvref_t<decltype(slot.effect)>::card.name) + "." +
                   std::string(model::name(channel)));
  });
  return found;
}

std::optional<model::RigFault> find_rig_fault(const model::RigParameters<double>& rig, double period) {
  if (const auto fault = model::find_fault(rig, period, model::RigModel<>::Line::longest)) return fault;
  // A time constant that no sample could show, but whose inverse the same exact step would have to bear.
  constexpr double shortest = 1e-9;  // [s]
  std::optional<model::RigFault> too_short;
  const auto check = [&too_short](const auto& slot, std::optional<model::Channel> channel) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    for (std::size_t i = 0; slot.active && i < Effect::values.size(); ++i) {
      const auto& card = Effect::card.parameters[i];
      const double value = slot.effect.*Effect::values[i];
      if (card.unit == "s" && value > 0.0 && value < shortest) {
        too_short = model::RigFault{Effect::card.name, card.name, "0, or at least 1e-9 s", channel};
      }
    }
  };
  rig.effects.for_each([&check](const auto& slot) { check(slot, std::nullopt); });
  rig.effects.for_each_sensor([&check](const auto& slot, model::Channel channel) { check(slot, channel); });
  if (too_short) return too_short;
  // What one unit of anything changes in a period. Beyond this limit the matrices of an exact step have no digit left.
  constexpr double largest = 1e8;
  using Equations = model::RigEquations<double>;
  const Equations equations(rig);
  bool resolved = true;
  const auto take = [&resolved, period](const auto& rates) {
    for (Eigen::Index i = 0; i < rates.size(); ++i) resolved = resolved && std::abs(rates(i)) * period <= largest;
  };
  for (int open = 0; open <= (rig.has_fdva ? rig.fdva.ducts : 0); ++open) {
    if (rig.kind == model::RigKind::component_bench) {
      using State = Equations::ComponentState;
      for (int j = 0; j < State::RowsAtCompileTime; ++j) take(equations.component(State::Unit(j), {}, open));
      take(equations.component(State::Zero(), {.minor_losses = 1e-4}, open));  // a duct's flow is below 10 l/s
    } else {
      using State = Equations::JoinedState;
      for (int j = 0; j < State::RowsAtCompileTime; ++j) take(equations.joined(State::Unit(j), {}, open));
      take(equations.joined(State::Zero(), {.minor_losses = 1e-4}, open));
    }
  }
  if (resolved) return std::nullopt;
  return model::RigFault{"", "", "stiffnesses, dampings and masses that a step of this length can resolve"};
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const auto& candidate : known) {
    const std::size_t distance = changes(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

RigDescription parse_rig(std::string_view text, std::string_view source) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw InputError(source, 0, "the file is empty", "a rig description, beginning with kind and sample_rate");
  }
  toml::table top_table;
  try {
    top_table = toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(source, error.source().begin.line, "TOML syntax: " + std::string(error.description()),
                     "a rig description in TOML");
  }
  RigDescription description;
  description.source = source;
  description.text = text;
  Reader top(top_table, "", source);
  description.rig.kind = read_kind(top);
  description.sample_rate = top.number("sample_rate");
  if (!(description.sample_rate >= 1.0 && description.sample_rate <= 1e5)) {
    top.fail("sample_rate", "sample_rate = " + shortest(description.sample_rate) + " does not fit",
             "the rate of the loop in Hz, from 1 to 100000");
  }
  read_parameters(top, description.rig);
  read_effects(top, description.rig);
  read_sensors(top, description);
  read_controller(top, description.rig, description.controller);
  read_delay_budget(top, description.rig.kind, description.delay_budget);
  read_hardware(top, description.rig, description.hardware);
  read_tolerances(top, description);
  top.finish();
  check_physics(top_table, description);
  return description;
}

RigDescription read_rig(const std::filesystem::path& file) {
  std::error_code status;
  if (std::filesystem::is_directory(file, status)) {
    throw InputError(file.string(), 0, "is a directory", "a rig description in TOML");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), 0, "cannot be opened", "a readable rig description in TOML");
  constexpr std::size_t longest = 1U << 20U;  // a description has some hundred lines; a device may never end
  std::string text(longest + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) throw InputError(file.string(), 0, "cannot be read", "a readable rig description in TOML");
  if (text.size() > longest) throw InputError(file.string(), 0, "is larger than 1 MiB", "a rig description in TOML");
  return parse_rig(text, file.string());
}

}  // namespace host_sim
