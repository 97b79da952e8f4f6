#include "firmware/description/rig_writer.hpp"

#include "firmware/description/calibration_reader.hpp"
#include "firmware/description/compensation_reader.hpp"
#include "firmware/description/model_watch.hpp"
#include "firmware/description/recorder_reader.hpp"
#include "firmware/description/semi_active_reader.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/text/toml_text.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/description/values/extensions.hpp"
#include "firmware/description/values/loop_settings.hpp"

namespace firmware {
namespace {

using model::RigKind;

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
    out.line(std::string(p.key), toml_float(p.value(rig)));
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
      out.line(std::string(effect.entry->parameters[i].name), toml_float(effect.values[i]));
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
    if (description.noise[c]) out.line(std::string(name(model::channel_at(c))), toml_float(*description.noise[c]));
  }
  out.table("range");
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const auto& range = description.range[c];
    if (!range) continue;
    out.line(std::string(name(model::channel_at(c))),
             "[" + toml_float(range->lower) + ", " + toml_float(range->upper) + "]");
  }
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (!description.calibration[c]) continue;
    out.table("calibration." + std::string(name(model::channel_at(c))));
    for (const auto& [key, value] : calibration_lines(*description.calibration[c])) out.line(key, value);
  }
  out.table("recording");
  for (const auto& [key, value] : recorder_lines(description.recorder)) out.line(key, value);
  out.table("channels");
  for (const auto& [key, source] : description.channels) {
    out.line(key, "{ column = " + toml_string(source.column) +
                      (source.scale ? ", scale = " + toml_float(*source.scale) : "") +
                      ", offset = " + toml_float(source.offset) + " }");
  }
}

void write_controller(Text& out, const RigDescription& description) {
  const ControllerDescription& controller = description.controller;
  out.table("limits");
  out.line("stroke", toml_float(controller.stroke));
  out.line("speed", toml_float(controller.speed));
  if (controller.force_given || controller.force != ControllerDescription{}.force)
    out.line("force", toml_float(controller.force));
  out.line("ramp", toml_float(controller.ramp));
  if (description.rig.kind == RigKind::hil) out.line("energy_gain", toml_float(controller.energy_gain));
  const Settings usual{};
  std::string_view open = "limits";
  for (const LoopSetting& setting : loop_settings()) {
    if (setting.table != open) out.table(std::string(open = setting.table));
    const double value = setting.get(controller.loop);
    if (value == setting.get(usual)) continue;
    out.line(std::string(setting.key), setting.whole ? std::to_string(static_cast<int>(value)) : toml_float(value));
  }
  out.table("estimator");
  if (controller.cross_over > 0.0) out.line("cross_over", toml_float(controller.cross_over));
  write_estimator(controller, [&out](const std::string& key, const std::string& value) { out.line(key, value); });
  out.table("valves");
  if (description.rig.has_fdva) out.line("safe", ducts(controller.safe_ducts));
  write_duct_policy(controller.ducts,
                    [&out](const std::string& key, const std::string& value) { out.line(key, value); });
  if (!controller.valve_plan.empty()) {
    std::string plan;
    for (const auto& entry : controller.valve_plan) {
      plan += (plan.empty() ? "{ t = " : ", { t = ") + toml_float(entry.time) + ", open = " + ducts(entry.open) + " }";
    }
    out.line("plan", "[" + plan + "]");
  }
  const Arming& arming = controller.arming;
  out.table("arming");
  out.line("tare_time", toml_float(arming.tare_time));
  if (arming.preload > 0.0) out.line("preload", toml_float(arming.preload));
  if (arming.sway > 0.0) out.line("sway", toml_float(arming.sway));
  if (arming.wander > 0.0) out.line("wander", toml_float(arming.wander));
  out.line("position_tolerance", toml_float(arming.position_tolerance));
  out.line("probe_amplitude", toml_float(arming.probe_amplitude));
  if (arming.stop_test > 0.0) out.line("stop_test", toml_float(arming.stop_test / 3600.0));
  out.line("force_ramp", toml_float(arming.force_ramp));
  out.table("waivers");
  for (const auto& [key, sentence] : description.waivers) out.line(key, toml_string(sentence));
  const DelayBudget& budget = description.delay_budget;
  out.table("delay_budget");
  if (budget.sensor_age > 0.0) out.line("sensor_age", toml_float(budget.sensor_age));
  if (budget.transport > 0.0) out.line("transport", toml_float(budget.transport));
  if (budget.computation > 0.0) out.line("computation", toml_float(budget.computation));
  if (description.compensation) {
    out.table("compensation");
    for (const auto& [key, value] : compensation_lines(*description.compensation)) out.line(key, value);
  }
}

void write_hardware(Text& out, const HardwareDescription& hardware, bool model_watch_stops) {
  const auto scaled = [&out](double scale, double offset) {
    out.line("scale", toml_float(scale));
    if (offset != 0.0) out.line("offset", toml_float(offset));
  };
  const ScheduleDescription &schedule = hardware.schedule, usual{};
  out.table("controller");
  if (schedule.priority != usual.priority) out.line("priority", std::to_string(schedule.priority));
  if (schedule.cpu >= 0) out.line("cpu", std::to_string(schedule.cpu));
  if (schedule.late_in_a_row != usual.late_in_a_row) {
    out.line("late_in_a_row", std::to_string(schedule.late_in_a_row));
  }
  if (schedule.wake_early != usual.wake_early) out.line("wake_early", toml_float(schedule.wake_early));
  if (schedule.allowed_delay > 0.0) out.line("allowed_delay", toml_float(schedule.allowed_delay));
  if (schedule.allowed_gain > 0.0) out.line("allowed_gain", toml_float(schedule.allowed_gain));
  if (model_watch_stops) out.line("model_watch", toml_string("stop"));
  if (!schedule.socket.empty()) out.line("socket", toml_string(schedule.socket));
  if (!schedule.proven.empty()) out.line("proven", toml_string(schedule.proven));
  if (hardware.gpio) {
    const GpioDescription& gpio = *hardware.gpio;
    const GpioDescription ordinary{};
    out.table("gpio");
    out.line("chip", toml_string(gpio.chip));
    std::string valves;
    for (const std::string& line : gpio.valves) valves += (valves.empty() ? "" : ", ") + toml_string(line);
    if (!gpio.valves.empty()) out.line("valves", "[" + valves + "]");
    if (gpio.valves_active_low) out.line("valves_active_low", "true");
    if (!gpio.stop.empty()) out.line("stop", toml_string(gpio.stop));
    if (!gpio.stop_2.empty()) out.line("stop_2", toml_string(gpio.stop_2));
    if (gpio.stop_bias != ordinary.stop_bias) out.line("stop_bias", toml_string(gpio.stop_bias));
    if (gpio.stop_active_low != pulls_down(gpio.stop_bias)) {
      out.line("stop_active_low", gpio.stop_active_low ? "true" : "false");
    }
    if (!gpio.enable.empty()) out.line("enable", toml_string(gpio.enable));
    if (gpio.enable_active_low) out.line("enable_active_low", "true");
    if (!gpio.enable_feedback.empty()) out.line("enable_feedback", toml_string(gpio.enable_feedback));
    if (gpio.enable_feedback_bias != ordinary.enable_feedback_bias) {
      out.line("enable_feedback_bias", toml_string(gpio.enable_feedback_bias));
    }
    if (!gpio.high_pressure.empty()) out.line("high_pressure", toml_string(gpio.high_pressure));
    if (!gpio.hold_to_run.empty()) out.line("hold_to_run", toml_string(gpio.hold_to_run));
    if (!gpio.heartbeat.empty()) out.line("heartbeat", toml_string(gpio.heartbeat));
    if (gpio.interlock_bias != ordinary.interlock_bias) {
      out.line("interlock_bias", toml_string(gpio.interlock_bias));
    }
    out.table("gpio.interlocks");
    for (const auto& [name, line] : gpio.interlocks) out.line(toml_string(name), toml_string(line));
  }
  if (hardware.converters) {
    const ConverterDescription& converters = *hardware.converters;
    out.table("converters");
    if (!converters.trigger.empty()) out.line("trigger", toml_string(converters.trigger));
    if (converters.trigger_rate > 0.0) out.line("trigger_rate", toml_float(converters.trigger_rate));
    if (converters.sample_age > 0.0) out.line("sample_age", toml_float(converters.sample_age));
    for (const auto& input : converters.inputs) {
      out.table("converters." + std::string(name(model::channel_at(input.channel))));
      out.line("device", toml_string(input.device));
      out.line("input", toml_string(input.input));
      scaled(input.scale, input.offset);
    }
    for (const auto& [name, output] :
         {std::pair("command", &converters.command), std::pair("area", &converters.area)}) {
      if (!*output) continue;
      out.table("converters." + std::string(name));
      out.line("device", toml_string((*output)->device));
      out.line("output", toml_string((*output)->output));
      scaled((*output)->scale, (*output)->offset);
      out.line("lowest_counts", std::to_string((*output)->lowest_counts));
      out.line("highest_counts", std::to_string((*output)->highest_counts));
    }
  }
  for (const LaserDescription& laser : hardware.lasers) {
    out.table("lasers." + std::string(name(model::channel_at(laser.channel))));
    out.line("port", toml_string(laser.port));
    out.line("baud", std::to_string(laser.baud));
    out.line("address", std::to_string(laser.address));
    out.line("range", toml_float(laser.range));
    scaled(laser.scale, laser.offset);
  }
}

}  // namespace

std::string format_rig(const RigDescription& description) {
  Text out;
  const bool driven = description.rig.kind == RigKind::driven_mass;
  out.line("kind", toml_string(name(driven ? RigKind::component_bench : description.rig.kind)));
  if (driven) out.line("driven_by", toml_string("force"));
  out.line("sample_rate", toml_float(description.sample_rate));
  write_parameters(out, description);
  write_effects(out, description.rig);
  write_laws(out, description);
  out.table("tolerance");
  for (const auto& [path, bound] : description.tolerance) out.line(toml_string(path), toml_float(bound));
  write_sensors(out, description);
  write_controller(out, description);
  write_hardware(out, description.hardware, model_watch_stops(description));
  return out.take();
}

}  // namespace firmware
