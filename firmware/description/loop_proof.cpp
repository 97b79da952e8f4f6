#include "firmware/description/loop_proof.hpp"

#include <cstdio>
#include <vector>

#include "firmware/description/compensation_reader.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/description/values/extensions.hpp"

namespace firmware {
namespace {

constexpr std::string_view write_limits = "write it by  rigtwin stability --write-limits ";

bool waived(const RigDescription& description) { return description.waivers.contains("unproven_stability"); }

std::string milliseconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f ms", 1e3 * seconds);
  return text;
}

/// The lines of a text with their ends.
std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::size_t length = end == std::string_view::npos ? text.size() : end + 1;
    lines.emplace_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return lines;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

/// "[controller]", with blanks and a comment where TOML allows them.
bool opens_controller(std::string_view line) {
  line = trimmed(line.substr(0, line.find('#')));
  return line.size() > 2 && line.front() == '[' && line.back() == ']' &&
         trimmed(line.substr(1, line.size() - 2)) == "controller";
}

/// Sets a key of the table that begins at line `header`: in its line, else in a new one below the header.
void set_key(std::vector<std::string>& lines, std::size_t header, std::string_view key, const std::string& value,
             const std::string& line_end) {
  for (std::size_t i = header + 1; i < lines.size() && trimmed(lines[i]).substr(0, 1) != "["; ++i) {
    const std::size_t equals = lines[i].find('=');
    if (equals == std::string::npos || trimmed(std::string_view(lines[i]).substr(0, equals)) != key) continue;
    const std::size_t begin = lines[i].find_first_not_of(" \t", equals + 1);
    if (begin == std::string::npos) return;
    const bool quoted = lines[i][begin] == '"' || lines[i][begin] == '\'';
    const std::size_t end =
        quoted ? lines[i].find(lines[i][begin], begin + 1) + 1 : lines[i].find_first_of(" \t\r\n#", begin);
    lines[i].replace(begin, end == std::string::npos ? end : end - begin, value);
    return;
  }
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(header) + 1, std::string(key) + " = " + value + line_end);
}

}  // namespace

std::string loop_text(const RigDescription& description) {
  std::string text;
  const auto line = [&text](std::string_view key, const std::string& value) {
    ((text += key) += " = ") += value + "\n";
  };
  RigDescription copy = description;
  line("kind", std::string(model::name(copy.rig.kind)));
  line("sample_rate", shortest(copy.sample_rate));
  for (const ParameterPath& path : parameter_paths()) {
    if (!has_part(copy.rig, path.table)) continue;
    line(std::string(path.table) + "." + std::string(path.key), shortest(path.value(copy.rig)));
  }
  if (copy.rig.has_fdva) {
    line("fdva.ducts", std::to_string(copy.rig.fdva.ducts));
    line("fdva.open_ducts", std::to_string(copy.rig.fdva.open_ducts));
  }
  for (const TableLine& extension : extension_lines(copy.rig)) {
    line(extension.table + "." + extension.key, extension.value);
  }
  for (const PlacedEffect& effect : effects_of(copy.rig)) {
    if (effect.values.empty()) line("effects", std::string(effect.entry->name));
    for (std::size_t i = 0; i < effect.values.size(); ++i) line(effect_path(effect, i), shortest(effect.values[i]));
  }
  for (const LawDescription& law : named_laws(copy.laws, copy.rig)) {
    for (const auto& [key, value] : law_lines(law, copy.rig)) line("laws." + law.name + "." + key, value);
  }
  line("delay_budget.sensor_age", shortest(copy.delay_budget.sensor_age));
  line("delay_budget.transport", shortest(copy.delay_budget.transport));
  line("delay_budget.computation", shortest(copy.delay_budget.computation));
  // What `rigtwin stability` found, so that a number written by hand is none.
  const double allowed = copy.hardware.schedule.allowed_delay;
  if (allowed > 0.0) line("controller.allowed_delay", shortest(allowed));
  const double gain = copy.hardware.schedule.allowed_gain;
  if (gain > 0.0) line("controller.allowed_gain", shortest(gain));
  if (copy.compensation) {
    for (const auto& [key, value] : compensation_lines(*copy.compensation)) line("compensation." + key, value);
  }
  for (const auto& entry : copy.controller.valve_plan)
    line("valves.plan", shortest(entry.time) + " " + std::to_string(entry.open));
  return text;
}

std::string loop_fingerprint(const RigDescription& description) { return "sha256:" + sha256(loop_text(description)); }

std::string with_loop_proof(std::string_view text, std::string_view source, const LoopLimits& limits,
                            std::string_view fingerprint) {
  RigDescription wanted = parse_rig(text, source);
  std::vector<std::string> lines = split_lines(text);
  const std::string line_end = text.find("\r\n") != std::string_view::npos ? "\r\n" : "\n";
  std::size_t header = 0;
  while (header < lines.size() && !opens_controller(lines[header])) ++header;
  if (header == lines.size()) {
    if (!lines.empty() && lines.back().back() != '\n') lines.back() += line_end;
    lines.push_back(line_end);
    lines.push_back("[controller]" + line_end);
    header = lines.size() - 1;
  }
  if (lines[header].back() != '\n') lines[header] += line_end;
  set_key(lines, header, "proven", "\"" + std::string(fingerprint) + "\"", line_end);
  set_key(lines, header, "allowed_gain", shortest(limits.gain), line_end);
  set_key(lines, header, "allowed_delay", shortest(limits.delay), line_end);
  std::string result;
  for (const std::string& line : lines) result += line;

  wanted.hardware.schedule.allowed_delay = limits.delay;
  wanted.hardware.schedule.allowed_gain = limits.gain;
  wanted.hardware.schedule.proven = fingerprint;
  const std::string expected = "a table [controller] of its own, with one key a line";
  try {
    if (format_rig(parse_rig(result, source)) == format_rig(wanted)) return result;
  } catch (const InputError&) {
    throw InputError(source, header + 1, "[controller] cannot be written into this text", expected);
  }
  throw InputError(source, header + 1, "[controller] cannot be written into this text", expected);
}

MotionObjection stability_objection(const RigDescription& description) {
  if (description.rig.kind != model::RigKind::hil || waived(description)) return {};
  const ScheduleDescription& schedule = description.hardware.schedule;
  const std::string how = std::string(write_limits) + description.source;
  if (schedule.proven.empty()) {
    return {"nothing says that this loop is stable" +
                std::string(description.compensation ? " with its compensation" : "") +
                " ([controller] proven): " + how,
            "controller.proven"};
  }
  if (schedule.proven != loop_fingerprint(description)) {
    return {"the loop has changed since it was found stable ([controller] proven): " + how, "controller.proven"};
  }
  if (schedule.allowed_delay == 0.0) return {"[controller] has no allowed_delay: " + how, "controller.allowed_delay"};
  if (schedule.allowed_gain == 0.0) return {"[controller] has no allowed_gain: " + how, "controller.allowed_gain"};
  return {};
}

MotionObjection delay_objection(const RigDescription& description, double measured_delay) {
  const double allowed = description.hardware.schedule.allowed_delay;
  if (description.rig.kind != model::RigKind::hil || waived(description) || measured_delay <= allowed) return {};
  return {"samples and computation take " + milliseconds(measured_delay) + " (P99.9), [controller] allowed_delay is " +
              milliseconds(allowed) + ": this loop may grow",
          "controller.allowed_delay"};
}

}  // namespace firmware
