#include "firmware/description/rig_description_controller.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/description/semi_active_reader.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/spelling.hpp"
#include "firmware/description/values/loop_settings.hpp"
#include "firmware/loop/valve_plan.hpp"
#include "hal/interlocks.hpp"

namespace firmware {
namespace {

model::OpenDucts read_ducts(DescriptionTable& table, std::string_view key, int installed) {
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
  if (!n || *n < 0 || *n > installed) table.fail(node, table.path(key) + " is not a valid number of ducts", expected);
  return model::first_ducts(static_cast<int>(*n));
}

using Waivers = std::map<std::string, std::string>;

/// A bias under the key, if it is there.
void read_bias(DescriptionTable& table, std::string_view key, std::string& bias) {
  if (!table.has(key)) return;
  bias = table.text(key);
  if (std::find(line_biases.begin(), line_biases.end(), bias) != line_biases.end()) return;
  table.fail(key, "unknown " + table.path(key) + " " + in_quotes(bias), "one of " + listed(line_biases));
}

/// The pull gives the level of a cut wire: that one must be "pressed".
void read_stop(DescriptionTable& table, const Waivers& waivers, GpioDescription& gpio) {
  if (table.has("stop")) gpio.stop = table.text("stop");
  if (table.has("stop_2")) gpio.stop_2 = table.text("stop_2");
  if (!gpio.stop_2.empty() && (gpio.stop.empty() || gpio.stop == gpio.stop_2)) {
    table.fail("stop_2", "gpio.stop_2 is no second contact", "a line beside gpio.stop");
  }
  read_bias(table, "stop_bias", gpio.stop_bias);
  gpio.stop_active_low = pulls_down(gpio.stop_bias);
  if (!table.has("stop_active_low")) return;
  const bool wanted = table.truth("stop_active_low");
  if (wanted != gpio.stop_active_low && !waivers.contains("stop_fails_dangerous")) {
    table.fail("stop_active_low", "a cut wire at gpio.stop would read released",
               "stop_active_low = " + std::string(gpio.stop_active_low ? "true" : "false") + " with stop_bias '" +
                   gpio.stop_bias + "' and a normally closed contact, or [waivers] stop_fails_dangerous = \"why\"");
  }
  gpio.stop_active_low = wanted;
}

void read_enable(DescriptionTable& table, const Waivers& waivers, GpioDescription& gpio) {
  if (table.has("enable")) gpio.enable = table.text("enable");
  if (table.has("enable_feedback")) gpio.enable_feedback = table.text("enable_feedback");
  read_bias(table, "enable_feedback_bias", gpio.enable_feedback_bias);
  if (!gpio.enable_feedback.empty() && (gpio.enable.empty() || gpio.enable_feedback == gpio.enable)) {
    table.fail("enable_feedback", "gpio.enable_feedback shows no enable", "an input beside the output gpio.enable");
  }
  if (!table.has("enable_active_low")) return;
  gpio.enable_active_low = table.truth("enable_active_low");
  if (gpio.enable_active_low && !waivers.contains("enable_active_low")) {
    table.fail("enable_active_low", "a line without a program would give the drive power",
               "enable_active_low = false, or [waivers] enable_active_low = \"why\"");
  }
}

void read_interlocks(DescriptionTable& table, GpioDescription& gpio) {
  read_bias(table, "interlock_bias", gpio.interlock_bias);
  auto interlocks = table.table("interlocks");
  if (!interlocks) return;
  for (const auto& [key, node] : interlocks->raw()) {
    const std::string name(key.str());
    if (gpio.interlocks.size() == hal::Interlocks::capacity) {
      interlocks->fail(node, "[gpio.interlocks] has too many", "at most 32");
    }
    gpio.interlocks.push_back({name, interlocks->text(name)});
  }
  interlocks->accept_all_keys();
}

void read_gpio(DescriptionTable& table, const model::RigParameters<double>& rig, const Waivers& waivers,
               GpioDescription& gpio) {
  gpio.source_line = table.line();
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
  read_stop(table, waivers, gpio);
  read_enable(table, waivers, gpio);
  if (table.has("high_pressure")) gpio.high_pressure = table.text("high_pressure");
  if (!gpio.high_pressure.empty() && (gpio.enable.empty() || gpio.high_pressure == gpio.enable)) {
    table.fail("high_pressure", "gpio.high_pressure is a second stage without a first one",
               "an output beside gpio.enable");
  }
  read_interlocks(table, gpio);
  if (table.has("hold_to_run")) {
    gpio.hold_to_run = table.text("hold_to_run");
    const bool known = std::any_of(gpio.interlocks.begin(), gpio.interlocks.end(),
                                   [&](const auto& interlock) { return interlock.name == gpio.hold_to_run; });
    if (!known) {
      table.fail("hold_to_run", "gpio.hold_to_run = " + in_quotes(gpio.hold_to_run) + " is no interlock",
                 "a NAME of [gpio.interlocks], whose contact somebody holds closed");
    }
  }
  if (table.has("heartbeat")) gpio.heartbeat = table.text("heartbeat");
  table.finish();
}

/// Calls use(channel, table) for each sub-table named like a channel; the caller reads the other keys.
template <class Use>
void for_each_named_channel(DescriptionTable& table, const Use& use) {
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (auto entry = table.table(model::channel_names[i].name)) {
      use(i, *entry);
      entry->finish();
    }
  }
}

std::optional<ConverterDescription::Output> read_output(DescriptionTable& table, std::string_view name) {
  auto entry = table.table(name);
  if (!entry) return std::nullopt;
  ConverterDescription::Output output{entry->text("device"), entry->text("output")};
  output.scale = entry->factor("scale");
  entry->optional_number("offset", output.offset);
  constexpr int most = 1 << 24;
  if (entry->has("lowest_counts")) output.lowest_counts = entry->whole_in("lowest_counts", -most, most);
  if (entry->has("highest_counts")) output.highest_counts = entry->whole_in("highest_counts", -most, most);
  if (output.lowest_counts >= output.highest_counts) {
    throw InputError(table.source(), entry->line(),
                     "converters." + std::string(name) + " has no counts between lowest and highest",
                     "lowest_counts < highest_counts");
  }
  entry->finish();
  return output;
}

void read_converters(DescriptionTable& table, double period, ConverterDescription& converters) {
  if (table.has("trigger")) converters.trigger = table.text("trigger");
  if (table.has("trigger_rate")) converters.trigger_rate = table.positive("trigger_rate");
  table.number_in("sample_age", converters.sample_age, 1e-6, period,
                  "the age of the converters' samples when a period begins in s, at most a period");
  for_each_named_channel(table, [&](std::size_t channel, DescriptionTable& entry) {
    ConverterDescription::Input input{channel, entry.text("device"), entry.text("input")};
    input.scale = entry.factor("scale");
    entry.optional_number("offset", input.offset);
    converters.inputs.push_back(std::move(input));
  });
  converters.command = read_output(table, "command");
  converters.area = read_output(table, "area");
  table.finish();
}

/// The settings of loop_settings() that stand in this table.
void read_loop_settings(DescriptionTable& table, std::string_view name, Settings& settings) {
  for (const LoopSetting& setting : loop_settings()) {
    if (setting.table != name) continue;
    double value = setting.get(settings);
    if (setting.whole) {
      const auto bound = [](double number) { return static_cast<int>(number); };
      if (table.has(setting.key)) value = table.whole_in(setting.key, bound(setting.lowest), bound(setting.highest));
    } else {
      table.number_in(setting.key, value, setting.lowest, setting.highest, setting.what);
    }
    setting.set(settings, value);
  }
}

/// Bounds are wide for a test rig and narrow enough to find a value in other units: 250.0 for a stroke of 250 mm
/// switched the limit off.
void read_limits(DescriptionTable& top, ControllerDescription& controller) {
  auto table = top.table("limits");
  if (!table) return;
  table->number_in("stroke", controller.stroke, 1e-3, 2.0, "the whole travel of the drive in m (not mm)");
  table->number_in("speed", controller.speed, 1e-3, 100.0, "a speed in m/s");
  controller.force_given = table->has("force");
  table->number_in("force", controller.force, 1.0, 1e6, "a force in N (not kN)");
  table->number_in("ramp", controller.ramp, 1e-4, 1.0, "the speed to the start and back to rest in m/s");
  table->number_in("energy_gain", controller.energy_gain, 1e-3, 100.0, "an energy ratio; 1 is the border of stability");
  if (controller.ramp > controller.speed) {
    table->fail(table->has("ramp") ? "ramp" : "speed", "limits.ramp is faster than limits.speed",
                "a ramp of at most " + shortest(controller.speed) + " m/s");
  }
  read_loop_settings(*table, "limits", controller.loop);
  const Limits& limits = controller.loop.limits;
  const auto within = [&](std::string_view key, double value, std::string_view of, double lowest, double highest) {
    if (!table->has(key) || (value >= lowest && value <= highest)) return;
    table->fail(key, table->path(key) + " = " + shortest(value) + " does not fit limits." + std::string(of),
                shortest(lowest) + " to " + shortest(highest));
  };
  within("measured_stroke", limits.measured_stroke, "stroke", controller.stroke, 2.0 * controller.stroke);
  within("measured_speed", limits.measured_speed, "speed", controller.speed, 10.0 * controller.speed);
  within("low_force", limits.low_force, "force", 0.0, controller.force);
  within("following", limits.following, "stroke", 0.0, 0.49 * controller.stroke);
  table->finish();
}

/// `frozen_samples`, as descriptions had it before `frozen_time`: that many at their sample rate.
void read_frozen_samples(DescriptionTable& table, double sample_rate, Settings& settings) {
  constexpr int most = 1'000'000;
  if (!table.has("frozen_samples")) return;
  if (table.has("frozen_time")) {
    table.fail("frozen_samples", table.path("frozen_samples") + " beside frozen_time", "frozen_time alone");
  }
  settings.supervision.frozen_time = table.whole_in("frozen_samples", 0, most) / sample_rate;
}

void read_supervision(DescriptionTable& top, double sample_rate, Settings& settings) {
  for (const std::string_view name : {"supervision", "motion"}) {
    auto table = top.table(name);
    if (!table) continue;
    read_loop_settings(*table, name, settings);
    if (name == "supervision") read_frozen_samples(*table, sample_rate, settings);
    table->finish();
  }
}

/// The kernel's address of a Unix domain socket holds 107 bytes.
std::string read_socket(DescriptionTable& table) {
  constexpr std::size_t longest = 107;
  std::string path = table.text("socket");
  if (!path.starts_with('/') || path.size() > longest) {
    table.fail("socket", table.path("socket") + " = " + in_quotes(path) + " does not fit",
               "an absolute path of at most 107 bytes, such as /run/rigtwin/front.sock");
  }
  return path;
}

/// "show" or "stop": model_watch.hpp asks for it.
void check_model_watch(DescriptionTable& table) {
  const std::string word = table.text("model_watch");
  if (word != "stop" && word != "show") {
    table.fail("model_watch", table.path("model_watch") + " = " + in_quotes(word) + " does not fit",
               "\"show\" or \"stop\"");
  }
}

}  // namespace

/// A waiver is a sentence by somebody who answers for it, not a switch.
void read_waivers(DescriptionTable& top, std::map<std::string, std::string>& waivers) {
  auto table = top.table("waivers");
  if (!table) return;
  for (const std::string_view name : waiver_names) {
    if (!table->has(name)) continue;
    const std::string sentence = table->text(name);
    if (std::count(sentence.begin(), sentence.end(), ' ') < 2) {
      table->fail(name, table->path(name) + " is no sentence",
                  "at least three words that say why the rig may go without, such as \"hand pump only, no drive\"");
    }
    waivers[std::string(name)] = sentence;
  }
  table->finish();
}

void read_controller(DescriptionTable& top, const model::RigParameters<double>& rig, double sample_rate,
                     ControllerDescription& controller) {
  read_limits(top, controller);
  read_supervision(top, sample_rate, controller.loop);
  read_estimator(top, rig.kind, controller);
  auto valves = top.table("valves");
  if (!valves) return;
  const int installed = rig.has_fdva ? rig.fdva.ducts : 0;
  if (valves->has("safe")) controller.safe_ducts = read_ducts(*valves, "safe", installed);
  read_duct_policy(*valves, rig, controller);
  if (valves->has("plan")) {
    const toml::node& node = valves->need("plan", "");
    const std::string expected = "a list of { t = seconds, open = ducts } with t >= 0 growing";
    const auto* list = node.as_array();
    if (list == nullptr) valves->fail(node, "valves.plan is not a list", expected);
    for (const auto& item : *list) {
      if (!item.is_table()) valves->fail(item, "an entry of valves.plan is not a table", expected);
      DescriptionTable entry(*item.as_table(), "valves.plan", valves->source());
      const double t = entry.number("t");
      if (t < 0.0 || (!controller.valve_plan.empty() && t <= controller.valve_plan.back().time)) {
        valves->fail(item, "the times of valves.plan do not grow", expected);
      }
      if (controller.valve_plan.size() == ValvePlan::capacity) {
        valves->fail(item, "valves.plan is too long", "at most " + std::to_string(ValvePlan::capacity) + " entries");
      }
      controller.valve_plan.push_back({t, read_ducts(entry, "open", installed)});
      entry.finish();
    }
  }
  valves->finish();
}

void read_delay_budget(DescriptionTable& top, model::RigKind kind, DelayBudget& budget) {
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

void read_arming(DescriptionTable& top, const Waivers& waivers, ControllerDescription& controller) {
  Arming& arming = controller.arming;
  arming.probe_amplitude = 2e-3;
  arming.off_centre = waivers.contains("off_centre");
  auto table = top.table("arming");
  if (!table) return;
  const auto within = [&](std::string_view key, double& value, double lowest, double highest, std::string_view what) {
    if (!table->has(key)) return;
    value = table->number(key);
    if (value >= lowest && value <= highest) return;
    table->fail(key, table->path(key) + " = " + shortest(value) + " does not fit",
                std::string(what) + " of " + shortest(lowest) + " to " + shortest(highest));
  };
  within("tare_time", arming.tare_time, 0.05, 10.0, "a time in s");
  within("preload", arming.preload, 1.0, controller.force, "a force in N, up to limits.force,");
  within("sway", arming.sway, 0.1, controller.force, "a force in N, up to limits.force,");
  within("wander", arming.wander, 1e-6, 0.1 * controller.stroke, "a length in m, up to a tenth of limits.stroke,");
  within("position_tolerance", arming.position_tolerance, 1e-4, 0.1 * controller.stroke,
         "a length in m, up to a tenth of limits.stroke,");
  within("probe_amplitude", arming.probe_amplitude, 0.0, 0.1 * controller.stroke,
         "a length in m, up to a tenth of limits.stroke,");
  double hours = 0.0;
  within("stop_test", hours, 0.01, 8760.0, "a time in hours");
  arming.stop_test = 3600.0 * hours;
  within("force_ramp", arming.force_ramp, 0.0, 10.0, "a time in s");
  if (arming.probe_amplitude == 0.0 && !waivers.contains("no_probe")) {
    table->fail("probe_amplitude", "arming without a probe does not find a wrong sign",
                "a length above 0 m, or [waivers] no_probe = \"why\"");
  }
  table->finish();
}

void read_hardware(DescriptionTable& top, const model::RigParameters<double>& rig, double period,
                   const Waivers& waivers, HardwareDescription& hardware) {
  if (auto controller = top.table("controller")) {
    ScheduleDescription& schedule = hardware.schedule;
    if (controller->has("priority")) schedule.priority = controller->whole_in("priority", 1, 99);
    if (controller->has("cpu")) schedule.cpu = controller->whole_in("cpu", 0, 1023);
    if (controller->has("late_in_a_row")) schedule.late_in_a_row = controller->whole_in("late_in_a_row", 1, 1000000);
    if (controller->has("wake_early")) schedule.wake_early = controller->not_negative("wake_early");
    controller->number_in("allowed_delay", schedule.allowed_delay, 1e-6, 0.5,
                          "the longest sample age and computation in s, as rigtwin stability --write-limits writes it");
    controller->number_in("allowed_gain", schedule.allowed_gain, 1.001, 100.0,
                          "a factor on the force, as rigtwin stability --write-limits writes it");
    if (controller->has("proven")) schedule.proven = controller->text("proven");
    if (controller->has("socket")) schedule.socket = read_socket(*controller);
    if (controller->has("model_watch")) check_model_watch(*controller);
    controller->finish();
  }
  if (auto gpio = top.table("gpio")) read_gpio(*gpio, rig, waivers, hardware.gpio.emplace());
  if (auto converters = top.table("converters")) read_converters(*converters, period, hardware.converters.emplace());
  if (auto lasers = top.table("lasers")) {
    for_each_named_channel(*lasers, [&](std::size_t channel, DescriptionTable& entry) {
      LaserDescription laser{channel, entry.text("port")};
      if (entry.has("baud")) laser.baud = entry.whole_in("baud", 2400, 921600);
      if (entry.has("address")) laser.address = entry.whole_in("address", 1, 127);
      laser.range = entry.positive("range");
      if (entry.has("scale")) laser.scale = entry.factor("scale");
      entry.optional_number("offset", laser.offset);
      hardware.lasers.push_back(std::move(laser));
    });
    lasers->finish();
  }
}

void check_stop_test(const DescriptionTable& top, const RigDescription& description) {
  if (description.controller.arming.stop_test <= 0.0) return;
  if (description.hardware.gpio && !description.hardware.gpio->stop.empty()) return;
  top.fail("arming", "arming.stop_test asks for a press of a button that is not there", "its line, [gpio] stop");
}

void check_wiring(const RigDescription& description) {
  if (!description.hardware.gpio) {
    throw InputError(description.source, 0, "no table [gpio]", "the lines of stop, heartbeat, enable and valves");
  }
  const GpioDescription& gpio = *description.hardware.gpio;
  const auto require_line = [&](const std::string& line, std::string_view key, std::string_view waiver,
                                std::string_view what) {
    if (!line.empty() || description.waivers.contains(std::string(waiver))) return;
    throw InputError(description.source, gpio.source_line, "[gpio] has no " + std::string(key),
                     std::string(what) + ", or [waivers] " + std::string(waiver) + " = \"why\"");
  };
  struct Line {
    const std::string& line;
    std::string_view key, waiver, what;
  };
  for (const Line& wanted : {Line{gpio.stop, "stop", "no_stop", "the line of the stop button"},
                             Line{gpio.heartbeat, "heartbeat", "no_heartbeat", "the line of a watchdog outside"},
                             Line{gpio.enable, "enable", "no_enable", "the line that gives the drive power"}}) {
    require_line(wanted.line, wanted.key, wanted.waiver, wanted.what);
  }
  if (gpio.enable.empty()) return;
  require_line(gpio.enable_feedback, "enable_feedback", "no_enable_feedback",
               "the line of a contact that shows whether the drive has power");
}

}  // namespace firmware
