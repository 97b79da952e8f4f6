#include "firmware/description/rig_writer.hpp"

#include <cstdio>

#include "firmware/description/compensation_reader.hpp"
#include "firmware/description/model_watch.hpp"
#include "firmware/description/recorder_reader.hpp"
#include "firmware/description/semi_active_reader.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/description/values/extensions.hpp"
#include "firmware/description/values/loop_settings.hpp"

namespace firmware {
namespace {

using model::RigKind;

/// A TOML basic string.
std::string basic_string_of(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      (result += '\\') += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04X", static_cast<unsigned>(c));
      result += code;
    } else {
      result += c;
    }
  }
  return result + "\"";
}

/// A TOML float: 40 is a whole number to TOML, 40.0 is not.
std::string real(double value) {
  std::string text = shortest(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string ducts(model::OpenDucts open) {
  std::string list;
  for (unsigned j = 0; j < recorded_ducts; ++j) {
    if ((open >> j & 1U) != 0U) list += (list.empty() ? "" : ", ") + std::to_string(j + 1);
  }
  return "[" + list + "]";
}

/// Tables one after the other; the heading appears with the first line below it.
class Text {
 public:
  void table(std::string heading) { heading_ = std::move(heading); }
  void line(const std::string& key, const std::string& value) {
    flush();
    text_ += key + " = " + value + "\n";
  }
  /// The heading even if nothing follows.
  void flush() {
    if (heading_.empty()) return;
    if (!text_.empty()) text_ += "\n";
    text_ += "[" + heading_ + "]\n";
    heading_.clear();
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_, heading_;
};

void write_parameters(Text& out, const RigDescription& description) {
  model::RigParameters<double> rig = description.rig;
  std::string_view table;
  const std::vector<TableLine> extensions = extension_lines(rig);
  const auto write_extensions = [&](std::string_view of) {
    for (const TableLine& line : extensions) {
      if (line.table == of) out.line(line.key, line.value);
    }
  };
  for (const ParameterPath& p : parameter_paths()) {
    if (rig.kind == RigKind::component_bench) {  // the car on which it drives may be absent
      if (p.table == "body" && rig.body.mass == 0.0) continue;
      if (p.table == "wheel" && rig.wheel.mass == 0.0) continue;
      if (p.table == "tyre" && rig.tyre.stiffness == 0.0) continue;
    }
    if (rig.kind == RigKind::driven_mass && (p.table == "wheel" || p.table == "tyre")) continue;
    if (p.table == "machine" && rig.kind != RigKind::hil) continue;
    if (p.table == "fdva" && !rig.has_fdva) continue;
    if (p.table == "air_spring" && !rig.air_spring.fitted) continue;
    if (p.table != table) {
      write_extensions(table);
      out.table(std::string(table = p.table));
    }
    out.line(std::string(p.key), real(p.value(rig)));
  }
  write_extensions(table);
  if (rig.has_fdva) {
    if (table != "fdva") out.table("fdva");
    out.line("ducts", std::to_string(rig.fdva.ducts));
    out.line("open_ducts", std::to_string(rig.fdva.open_ducts));
  }
  if (rig.kind == RigKind::component_bench) {
    out.table("machine");
    write_extensions("machine");
  }
  out.table("lever");
  write_extensions("lever");
}

void write_effects(Text& out, const model::RigParameters<double>& rig) {
  for (const PlacedEffect& effect : effects_of(rig)) {
    std::string heading = "effects." + std::string(effect.entry->name);
    if (effect.channel) heading += "." + std::string(model::name(*effect.channel));
    out.table(heading);
    out.flush();
    for (std::size_t i = 0; i < effect.values.size(); ++i) {
      out.line(std::string(effect.entry->parameters[i].name), real(effect.values[i]));
    }
  }
}

void write_laws(Text& out, const RigDescription& description) {
  for (const LawDescription& law : named_laws(description.laws, description.rig)) {
    out.table("laws." + law.name);
    for (const auto& [key, value] : law_lines(law, description.rig)) out.line(key, value);
  }
}

void write_sensors(Text& out, const RigDescription& description) {
  out.table("noise");
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (description.noise[c]) out.line(std::string(name(model::channel_at(c))), real(*description.noise[c]));
  }
  out.table("range");
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const auto& range = description.range[c];
    if (!range) continue;
    out.line(std::string(name(model::channel_at(c))), "[" + real(range->lower) + ", " + real(range->upper) + "]");
  }
  out.table("recording");
  for (const auto& [key, value] : recorder_lines(description.recorder)) out.line(key, value);
  out.table("channels");
  for (const auto& [key, source] : description.channels) {
    out.line(key, "{ column = " + basic_string_of(source.column) +
                      (source.scale ? ", scale = " + real(*source.scale) : "") + ", offset = " + real(source.offset) +
                      " }");
  }
}

void write_controller(Text& out, const RigDescription& description) {
  const ControllerDescription& controller = description.controller;
  out.table("limits");
  out.line("stroke", real(controller.stroke));
  out.line("speed", real(controller.speed));
  if (controller.force_given || controller.force != ControllerDescription{}.force)
    out.line("force", real(controller.force));
  out.line("ramp", real(controller.ramp));
  if (description.rig.kind == RigKind::hil) out.line("energy_gain", real(controller.energy_gain));
  const Settings usual{};
  std::string_view open = "limits";
  for (const LoopSetting& setting : loop_settings()) {
    if (setting.table != open) out.table(std::string(open = setting.table));
    const double value = setting.get(controller.loop);
    if (value == setting.get(usual)) continue;
    out.line(std::string(setting.key), setting.whole ? std::to_string(static_cast<int>(value)) : real(value));
  }
  out.table("estimator");
  if (controller.cross_over > 0.0) out.line("cross_over", real(controller.cross_over));
  write_estimator(controller, [&out](const std::string& key, const std::string& value) { out.line(key, value); });
  out.table("valves");
  if (description.rig.has_fdva) out.line("safe", ducts(controller.safe_ducts));
  write_duct_policy(controller.ducts,
                    [&out](const std::string& key, const std::string& value) { out.line(key, value); });
  if (!controller.valve_plan.empty()) {
    std::string plan;
    for (const auto& entry : controller.valve_plan) {
      plan += (plan.empty() ? "{ t = " : ", { t = ") + real(entry.time) + ", open = " + ducts(entry.open) + " }";
    }
    out.line("plan", "[" + plan + "]");
  }
  const Arming& arming = controller.arming;
  out.table("arming");
  out.line("tare_time", real(arming.tare_time));
  if (arming.preload > 0.0) out.line("preload", real(arming.preload));
  if (arming.sway > 0.0) out.line("sway", real(arming.sway));
  if (arming.wander > 0.0) out.line("wander", real(arming.wander));
  out.line("position_tolerance", real(arming.position_tolerance));
  out.line("probe_amplitude", real(arming.probe_amplitude));
  if (arming.stop_test > 0.0) out.line("stop_test", real(arming.stop_test / 3600.0));
  out.line("force_ramp", real(arming.force_ramp));
  out.table("waivers");
  for (const auto& [key, sentence] : description.waivers) out.line(key, basic_string_of(sentence));
  const DelayBudget& budget = description.delay_budget;
  out.table("delay_budget");
  if (budget.sensor_age > 0.0) out.line("sensor_age", real(budget.sensor_age));
  if (budget.transport > 0.0) out.line("transport", real(budget.transport));
  if (budget.computation > 0.0) out.line("computation", real(budget.computation));
  if (description.compensation) {
    out.table("compensation");
    for (const auto& [key, value] : compensation_lines(*description.compensation)) out.line(key, value);
  }
}

void write_hardware(Text& out, const HardwareDescription& hardware, bool model_watch_stops) {
  const auto scaled = [&out](double scale, double offset) {
    out.line("scale", real(scale));
    if (offset != 0.0) out.line("offset", real(offset));
  };
  const ScheduleDescription &schedule = hardware.schedule, usual{};
  out.table("controller");
  if (schedule.priority != usual.priority) out.line("priority", std::to_string(schedule.priority));
  if (schedule.cpu >= 0) out.line("cpu", std::to_string(schedule.cpu));
  if (schedule.late_in_a_row != usual.late_in_a_row) {
    out.line("late_in_a_row", std::to_string(schedule.late_in_a_row));
  }
  if (schedule.wake_early != usual.wake_early) out.line("wake_early", real(schedule.wake_early));
  if (schedule.allowed_delay > 0.0) out.line("allowed_delay", real(schedule.allowed_delay));
  if (schedule.allowed_gain > 0.0) out.line("allowed_gain", real(schedule.allowed_gain));
  if (model_watch_stops) out.line("model_watch", basic_string_of("stop"));
  if (!schedule.socket.empty()) out.line("socket", basic_string_of(schedule.socket));
  if (!schedule.proven.empty()) out.line("proven", basic_string_of(schedule.proven));
  if (hardware.gpio) {
    const GpioDescription& gpio = *hardware.gpio;
    const GpioDescription ordinary{};
    out.table("gpio");
    out.line("chip", basic_string_of(gpio.chip));
    std::string valves;
    for (const std::string& line : gpio.valves) valves += (valves.empty() ? "" : ", ") + basic_string_of(line);
    if (!gpio.valves.empty()) out.line("valves", "[" + valves + "]");
    if (gpio.valves_active_low) out.line("valves_active_low", "true");
    if (!gpio.stop.empty()) out.line("stop", basic_string_of(gpio.stop));
    if (!gpio.stop_2.empty()) out.line("stop_2", basic_string_of(gpio.stop_2));
    if (gpio.stop_bias != ordinary.stop_bias) out.line("stop_bias", basic_string_of(gpio.stop_bias));
    if (gpio.stop_active_low != pulls_down(gpio.stop_bias)) {
      out.line("stop_active_low", gpio.stop_active_low ? "true" : "false");
    }
    if (!gpio.enable.empty()) out.line("enable", basic_string_of(gpio.enable));
    if (gpio.enable_active_low) out.line("enable_active_low", "true");
    if (!gpio.enable_feedback.empty()) out.line("enable_feedback", basic_string_of(gpio.enable_feedback));
    if (gpio.enable_feedback_bias != ordinary.enable_feedback_bias) {
      out.line("enable_feedback_bias", basic_string_of(gpio.enable_feedback_bias));
    }
    if (!gpio.high_pressure.empty()) out.line("high_pressure", basic_string_of(gpio.high_pressure));
    if (!gpio.hold_to_run.empty()) out.line("hold_to_run", basic_string_of(gpio.hold_to_run));
    if (!gpio.heartbeat.empty()) out.line("heartbeat", basic_string_of(gpio.heartbeat));
    if (gpio.interlock_bias != ordinary.interlock_bias) {
      out.line("interlock_bias", basic_string_of(gpio.interlock_bias));
    }
    out.table("gpio.interlocks");
    for (const auto& [name, line] : gpio.interlocks) out.line(basic_string_of(name), basic_string_of(line));
  }
  if (hardware.converters) {
    const ConverterDescription& converters = *hardware.converters;
    out.table("converters");
    if (!converters.trigger.empty()) out.line("trigger", basic_string_of(converters.trigger));
    if (converters.trigger_rate > 0.0) out.line("trigger_rate", real(converters.trigger_rate));
    if (converters.sample_age > 0.0) out.line("sample_age", real(converters.sample_age));
    for (const auto& input : converters.inputs) {
      out.table("converters." + std::string(name(model::channel_at(input.channel))));
      out.line("device", basic_string_of(input.device));
      out.line("input", basic_string_of(input.input));
      scaled(input.scale, input.offset);
    }
    for (const auto& [name, output] :
         {std::pair("command", &converters.command), std::pair("area", &converters.area)}) {
      if (!*output) continue;
      out.table("converters." + std::string(name));
      out.line("device", basic_string_of((*output)->device));
      out.line("output", basic_string_of((*output)->output));
      scaled((*output)->scale, (*output)->offset);
      out.line("lowest_counts", std::to_string((*output)->lowest_counts));
      out.line("highest_counts", std::to_string((*output)->highest_counts));
    }
  }
  for (const LaserDescription& laser : hardware.lasers) {
    out.table("lasers." + std::string(name(model::channel_at(laser.channel))));
    out.line("port", basic_string_of(laser.port));
    out.line("baud", std::to_string(laser.baud));
    out.line("address", std::to_string(laser.address));
    out.line("range", real(laser.range));
    scaled(laser.scale, laser.offset);
  }
}

}  // namespace

std::string format_rig(const RigDescription& description) {
  Text out;
  const bool driven = description.rig.kind == RigKind::driven_mass;
  out.line("kind", basic_string_of(name(driven ? RigKind::component_bench : description.rig.kind)));
  if (driven) out.line("driven_by", basic_string_of("force"));
  out.line("sample_rate", real(description.sample_rate));
  write_parameters(out, description);
  write_effects(out, description.rig);
  write_laws(out, description);
  out.table("tolerance");
  for (const auto& [path, bound] : description.tolerance) out.line(basic_string_of(path), real(bound));
  write_sensors(out, description);
  write_controller(out, description);
  write_hardware(out, description.hardware, model_watch_stops(description));
  return out.take();
}

}  // namespace firmware
