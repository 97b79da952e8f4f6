#include "host_sim/commands/stability_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "firmware/description/loop_proof.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/loop_limits.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/compensation/stability_section.hpp"
#include "host_sim/report/formatted.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/report/json.hpp"
#include "host_sim/stability/report/stability_report.hpp"
#include "host_sim/stability/report/verdict.hpp"

namespace host_sim {
namespace {

using stability::Complex;
using stability::StabilityAnalysis;

std::string milliseconds(double seconds) { return formatted("%.4g ms", 1e3 * seconds); }

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

void print_roots(const StabilityAnalysis& a) {
  std::printf("in continuous time, without sampling and hold\n");
  std::printf("roots right of Re = %.4g 1/s: %d, proven by the argument principle\n", a.roots.line, a.roots.count);
  std::printf("  %14s %14s %10s %10s\n", "Re [1/s]", "Im [1/s]", "f [Hz]", "damping");
  for (const Complex s : a.roots.roots) {
    std::printf("  %14.7g %14.7g %10.4f %9.2f %%\n", s.real(), s.imag(), s.imag() / full_turn,
                std::abs(s) > 0.0 ? -100.0 * s.real() / std::abs(s) : 0.0);
  }
}

void print_gain(const char* name, const std::optional<stability::GainMargin>& gain) {
  if (!gain) return;
  std::printf("  %-25s force × %.4g (%+.2f dB) at %.4g Hz\n", name, gain->factor, 20.0 * std::log10(gain->factor),
              gain->omega / full_turn);
}

void print_border(const StabilityAnalysis& a, double virtual_damping) {
  const auto& m = a.margins;
  std::printf("margins without sampling and hold\n");
  if (m.critical_delay) {
    std::printf("  critical delay            %s at %.4g Hz, given %s\n",
                formatted("%.6g ms", 1e3 * *m.critical_delay).c_str(), m.critical_omega / full_turn,
                formatted("%.6g ms", 1e3 * a.delay).c_str());
  } else {
    std::printf("  critical delay            none up to 1 s\n");
  }
  if (a.critical_damping) {
    std::printf("  critical virtual damping  %.6g N s/m at %.4g Hz, given %.6g N s/m\n", a.critical_damping->value,
                a.critical_damping->omega / full_turn, virtual_damping);
  } else {
    std::printf("  critical virtual damping  none from 0 to 10000 N s/m, given %.6g N s/m\n", virtual_damping);
  }
  print_gain("gain margin, upwards", m.upper_gain);
  print_gain("gain margin, downwards", m.lower_gain);
  if (m.phase_margin) {
    std::printf("  phase margin              %.2f° at %.4g Hz\n", *m.phase_margin * 360.0 / full_turn,
                m.phase_margin_omega / full_turn);
  }
  std::printf("  sensitivity peak          %.4g at %.4g Hz\n", a.sensitivity.value, a.sensitivity.omega / full_turn);
}

void print_sampled(const StabilityAnalysis& a, double virtual_damping) {
  if (!a.sampled) {
    std::printf("sampled loop: not analysed: a delay beyond the model's line at this rate\n");
    return;
  }
  const auto& s = *a.sampled;
  std::printf("sampled loop at %.6g Hz, as it runs: %s, spectral radius %.7f (%zu states)\n", 1.0 / s.period,
              s.stable() ? "stable" : "unstable", s.spectral_radius, s.states);
  if (s.critical_delay) {
    std::printf("  critical delay            %s, given %s\n",
                formatted("%.6g ms", 1e3 * (*s.critical_delay + a.rig.sensor_delay)).c_str(),
                formatted("%.6g ms", 1e3 * a.delay).c_str());
  }
  if (s.added_delay) {
    std::printf("  sampling and hold add     %s of delay (%.2f steps)\n", milliseconds(*s.added_delay).c_str(),
                *s.added_delay / s.period);
  }
  if (a.sampled_damping) {
    std::printf("  critical virtual damping  %.6g N s/m at %.4g Hz, given %.6g N s/m\n", a.sampled_damping->value,
                a.sampled_damping->omega / full_turn, virtual_damping);
  }
  if (!a.sampled_margins) return;
  const auto& m = *a.sampled_margins;
  print_gain("gain margin, upwards", m.upper_gain);
  print_gain("gain margin, downwards", m.lower_gain);
  if (m.phase_margin) {
    std::printf("  phase margin              %.2f° at %.4g Hz\n", *m.phase_margin * 360.0 / full_turn,
                m.phase_margin_omega / full_turn);
  }
  std::printf("  sensitivity peak          %.4g at %.4g Hz\n", m.sensitivity.value, m.sensitivity.omega / full_turn);
}

void print_varying(const StabilityAnalysis& a) {
  if (!a.varying) return;
  const auto& v = *a.varying;
  const double range = v.highest - v.lowest;
  std::printf("delay that varies from %s to %s\n", milliseconds(v.lowest).c_str(), milliseconds(v.highest).c_str());
  const auto slowly = [](bool stable) {
    return stable ? "stable at every delay of the range" : "unstable within the range";
  };
  const auto speed = [](const std::optional<double>& proven, bool whole) {
    if (!proven) return;
    std::printf("  at any speed: proven stable up to %s above the lowest (sufficient), %s\n",
                milliseconds(*proven).c_str(), whole ? "the whole range" : "not the whole range: its speed decides");
  };
  if (const auto& s = a.sampled_over_delays) {
    std::printf("  sampled, slowly: %s; spectral radius %.7f at %s\n", slowly(s->stable), s->worst_radius,
                milliseconds(s->worst_delay + a.rig.sensor_delay).c_str());
    speed(s->at_any_speed, s->stable_at_any_speed(range));
  }
  std::printf("  without sampling and hold, slowly: %s; rightmost root %.4g %+.4gj 1/s at %s\n", slowly(v.stable),
              v.worst_root.real(), v.worst_root.imag(), milliseconds(v.worst_delay).c_str());
  speed(v.at_any_speed, v.stable_at_any_speed());
}

std::string border_text(const stability::LocatedBorder& border) {
  if (!border.stable_undelayed) return "unstable";
  return border.critical_delay ? milliseconds(*border.critical_delay) : std::string("none");
}

void print_locations(const StabilityAnalysis& a) {
  std::printf(
      "interface location, without sampling and hold: critical delay, and with the component's force times a factor\n  "
      "%-20s %12s",
      "hardware", "as given");
  for (const double factor : stability::component_factors) std::printf(" %11s", formatted("× %.4g", factor).c_str());
  std::printf("\n");
  for (const auto& map : a.locations) {
    std::printf("  %-20s %12s", std::string(stability::interface_names[static_cast<std::size_t>(map.location)]).c_str(),
                border_text(map.given).c_str());
    for (const auto& border : map.borders) std::printf(" %10s", border_text(border).c_str());
    std::printf("\n");
  }
}

void print_pade(const StabilityAnalysis& a) {
  if (!a.margins.critical_delay) return;
  std::printf("Padé in place of the delay\n");
  for (const auto& p : a.pade) {
    if (p.critical_delay) {
      std::printf("  order %d: critical delay %.6g ms, %+.2g %%, %s\n", p.order, 1e3 * *p.critical_delay,
                  100.0 * *p.error, p.unsafe ? "on the unsafe side" : "on the safe side");
    } else {
      std::printf("  order %d: finds no critical delay, on the unsafe side\n", p.order);
    }
  }
}

void print_budget(const StabilityAnalysis& a) {
  std::printf("delay budget\n");
  for (const auto& part : a.balance.parts) {
    const bool lag = part.name.starts_with("lag");
    std::printf("  %-52s %9.4f ms%s\n", part.name.c_str(), 1e3 * part.seconds,
                lag ? "   (part of the equations, not added)" : "");
  }
  std::printf("  %-52s %9.4f ms", "total", 1e3 * a.balance.total);
  if (a.balance.left)
    std::printf(", %.4f ms %s", 1e3 * std::abs(*a.balance.left),
                *a.balance.left >= 0.0 ? "below the critical delay" : "above the critical delay");
  std::printf("\n");
}

void print_sensitivities(const StabilityAnalysis& a) {
  constexpr std::size_t most = 8;
  std::printf(
      "effect of +1 %% of each parameter on the critical root (%.4g %+.4gj 1/s) and on the critical delay, "
      "without sampling and hold\n",
      a.critical_root.real(), a.critical_root.imag());
  for (std::size_t i = 0; i < std::min(most, a.parameters.size()); ++i) {
    const auto& s = a.parameters[i];
    std::printf("  %-36s %+11.4g 1/s %+11.4g Hz", s.path.c_str(), 0.01 * s.critical_root_change.real(),
                0.01 * s.critical_root_change.imag() / full_turn);
    if (a.margins.critical_delay && std::abs(s.critical_delay_change) > 1e-12) {
      std::printf(" %+11.4g ms", 10.0 * s.critical_delay_change);
    }
    std::printf("\n");
  }
}

void print_map(const stability::StabilityMap& map) {
  const auto stable = std::count_if(map.rightmost.begin(), map.rightmost.end(), [](double re) { return re < 0.0; });
  const auto [low, high] = std::minmax_element(map.rightmost.begin(), map.rightmost.end());
  std::size_t points = 0;
  for (const auto& curve : map.boundary) points += curve.points.size();
  std::printf(
      "map %s × %s, half a step of hold in the delay: %.1f %% of %zu points stable, rightmost Re %.4g … %.4g 1/s, %zu "
      "points on borders\n",
      map.x.variable.c_str(), map.y.variable.c_str(),
      100.0 * static_cast<double>(stable) / static_cast<double>(map.rightmost.size()), map.rightmost.size(), *low,
      *high, points);
}

void print_sweep(const stability::PoleSweep& sweep) {
  std::printf("sweep of %s, half a step of hold in the delay\n", sweep.axis.variable.c_str());
  std::printf("  %14s %14s %10s\n", sweep.axis.variable.c_str(), "Re [1/s]", "f [Hz]");
  for (std::size_t i = 0; i < sweep.axis.count; ++i) {
    const Complex s = sweep.roots[i].front();
    std::printf("  %14.7g %14.7g %10.4f\n", sweep.axis.value(i), s.real(), s.imag() / full_turn);
  }
}

void print_amplitudes(const stability::OverAmplitude& over) {
  std::printf("over the amplitude of dz_b, with half a step of hold, the nonlinear forces by their first harmonic\n");
  std::printf("  %11s %9s %12s %12s %12s %15s\n", "dz_b [mm]", "f [Hz]", "k [N/m]", "c [N s/m]", "Re [1/s]",
              "critical delay");
  for (const auto& at : over.rows) {
    std::printf("  %11.4g %9.4f %12.5g %12.5g %12.5g %15s\n", 1e3 * at.amplitude, at.omega / full_turn,
                at.suspension.stiffness, at.suspension.damping, at.root.real(),
                at.critical_delay ? formatted("%.6g ms", 1e3 * *at.critical_delay).c_str() : "none");
  }
  for (const auto& cycle : over.limit_cycles) std::printf("  %s\n", stability::in_words(cycle).c_str());
  if (!over.left_out.empty()) std::printf("  not counted: %s\n", joined(over.left_out).c_str());
}

void print_compensated(const compensation::CompensatedStability& s) {
  std::printf("with compensation %s: spectral radius %.6g, assumed %.4g ms of %.4g ms of delay\n",
              std::string(name(s.kind)).c_str(), s.spectral_radius, 1e3 * s.assumed_delay, 1e3 * s.delay);
  std::printf("  %14s %14s %10s\n", "Re [1/s]", "Im [1/s]", "f [Hz]");
  constexpr std::size_t most = 6;
  for (std::size_t i = 0; i < std::min(most, s.roots.size()); ++i) {
    std::printf("  %14.7g %14.7g %10.4f\n", s.roots[i].real(), s.roots[i].imag(), s.roots[i].imag() / full_turn);
  }
  const auto factor = [](const std::optional<double>& gain) {
    return gain ? formatted("%.4g", *gain) : std::string("none");
  };
  if (s.stable) {
    std::printf("  force factor at the border: %s above 1, %s below\n", factor(s.upper_gain).c_str(),
                factor(s.lower_gain).c_str());
  }
  std::printf("  true - described delay [ms], spectral radius:");
  for (std::size_t i = 0; i < s.mismatch.error.size(); i += 2) {
    std::printf(" %.3g: %.4f", 1e3 * s.mismatch.error[i], s.mismatch.radius[i]);
  }
  std::printf("\n");
}

void write_limits(const firmware::RigDescription& description, const std::string& json) {
  const double delay = allowed_delay(description);
  const firmware::LoopLimits limits{.delay = delay, .gain = allowed_gain(description, delay)};
  firmware::RigDescription proven = description;
  proven.hardware.schedule.allowed_delay = limits.delay;
  proven.hardware.schedule.allowed_gain = limits.gain;
  const std::string fingerprint = firmware::loop_fingerprint(proven);
  const std::string text = firmware::with_loop_proof(description.text, description.source, limits, fingerprint);
  const bool only_json = write_json(json, {{"schema", "rigtwin/limits/1"},
                                           {"rig", description.source},
                                           {"allowed_delay", limits.delay},
                                           {"allowed_gain", limits.gain},
                                           {"proven", fingerprint}});  // its input is still as read
  firmware::write_file(description.source, text);
  if (only_json) return;
  std::printf("%s: stable; [controller] allowed_delay = %.6g s, allowed_gain = %.4g, proven = %.20s…\n",
              description.source.c_str(), limits.delay, limits.gain, fingerprint.c_str());
}

/// The rig that the options ask about. UsageError, InputError where they or the rig do not allow it.
firmware::RigDescription examined_rig(const StabilityOptions& options) {
  if (options.write_limits && !options.rig.empty() && options.rig != *options.write_limits) {
    throw firmware::UsageError("--rig and --write-limits name different files, expected one");
  }
  if (!options.write_limits && options.rig.empty()) throw firmware::UsageError("--rig is required");
  firmware::RigDescription description = firmware::read_rig(options.write_limits.value_or(options.rig));
  if (options.amplitude && !(*options.amplitude >= 1e-6 && *options.amplitude <= 1.0)) {
    throw firmware::UsageError("--amplitude is not a deflection, expected 1e-6 … 1 m");
  }
  if (!(options.line < 0.0)) {
    throw firmware::UsageError("--right-of is not below 0, expected a negative real part, such as -60");
  }
  if (description.rig.kind != model::RigKind::hil) {
    throw firmware::InputError(
        description.source, 0,
        "stability analysis needs the loop of a hil rig, this is a " + std::string(model::name(description.rig.kind)),
        "kind = \"hil\"");
  }
  if (options.report && options.json == options.report) {
    throw firmware::UsageError("--json and --report name the same file, expected two files");
  }
  return description;
}

/// Everything that was asked for.
struct StabilityResults {
  StabilityAnalysis analysis;
  std::vector<stability::PoleSweep> sweeps{};
  std::optional<stability::StabilityMap> map{};
  std::optional<stability::OverAmplitude> over{};
  std::optional<compensation::CompensatedStability> compensated{};
  std::optional<compensation::MismatchMap> mismatch{};  ///< for the page, with a compensation
};

StabilityResults results_of(const StabilityOptions& options, const firmware::RigDescription& description) {
  std::optional<std::pair<stability::Axis, stability::Axis>> axes;
  if (options.map) axes = stability::parse_map(*options.map, description.rig, description.period());
  std::vector<stability::Axis> sweeps;
  for (const std::string& sweep : options.sweeps) {
    sweeps.push_back(stability::parse_axis(sweep, description.rig, description.period()));
  }

  StabilityResults found{.analysis = stability::analyse(description, options.line)};
  found.analysis.locations = stability::compare_locations(description.rig);
  const double delay_outside = description.delay_budget.sum();
  // What is said of the loop is said of the one that runs: half a step of hold.
  const stability::LoopFamily family(description.rig, delay_outside + 0.5 * description.period());
  for (const stability::Axis& axis : sweeps) found.sweeps.push_back(pole_sweep(family, axis, options.line));
  if (axes) {
    Progress progress("stability map");
    found.map = stability_map(family, axes->first, axes->second, 0, [&](double share) { progress.show(share); });
  }
  if (options.amplitude) found.over = stability::over_amplitude(description, *options.amplitude);
  if (!description.compensation) return found;
  found.compensated = compensation::compensated_stability(description, delay_outside);
  if (options.report) {
    Progress progress("map of assumed and true delay");
    found.mismatch =
        compensation::mismatch_map(description, delay_outside, [&](double share) { progress.show(share); });
  }
  return found;
}

void write_page(const std::filesystem::path& file, const firmware::RigDescription& description,
                const StabilityResults& found) {
  stability::StabilityFindings findings{description, found.analysis, found.sweeps, found.map, found.over};
  const auto& compensated = found.compensated;
  if (compensated) {
    findings.compensated =
        "With compensation " + std::string(name(compensated->kind)) + " the loop is " + in_words(*compensated) + ".";
    findings.compensated_stable = compensated->stable;
  }
  report::Report page = stability::stability_report(findings);
  if (compensated) compensation::add_stability_section(page, *compensated, *found.mismatch);
  firmware::write_file(file, with_how_made(page.html()));
}

nlohmann::ordered_json json_of(const StabilityResults& found, const firmware::RigDescription& description,
                               bool responses) {
  const StabilityAnalysis& a = found.analysis;
  nlohmann::ordered_json json = stability::to_json(a, description);
  if (found.compensated) {
    json["stable_without_compensation"] = json["stable"];
    json["stable"] = found.compensated->stable;
    json["compensation"] = compensation::to_json(*found.compensated, found.mismatch);
  }
  if (!found.sweeps.empty()) json["sweeps"] = nlohmann::ordered_json::array();
  for (const auto& sweep : found.sweeps) json["sweeps"].push_back(stability::to_json(sweep));
  if (found.map) json["map"] = stability::to_json(*found.map);
  if (found.over) json["over_amplitude"] = stability::to_json(*found.over);
  if (responses) {
    json["bode"] = stability::to_json(
        stability::bode(a.rig, a.delay, a.machine_delay, stability::frequencies(0.1, 100.0, 600, a.roots.roots)));
    json["nyquist"] = stability::to_json(stability::nyquist(a.equation(), a.roots.roots));
  }
  return json;
}

void print_results(const std::string& rig, const firmware::RigDescription& description, const StabilityResults& found) {
  const StabilityAnalysis& a = found.analysis;
  if (found.compensated) {
    std::printf("%s: with compensation %s %s\n", rig.c_str(), std::string(name(found.compensated->kind)).c_str(),
                in_words(*found.compensated).c_str());
    print_compensated(*found.compensated);
    std::printf("without it: %s\n", stability::verdict(a).c_str());
  } else {
    std::printf("%s: %s\n", rig.c_str(), stability::verdict(a).c_str());
  }
  print_sampled(a, description.rig.machine.virtual_damping);
  print_varying(a);
  print_roots(a);
  print_border(a, description.rig.machine.virtual_damping);
  print_locations(a);
  print_pade(a);
  print_budget(a);
  print_sensitivities(a);
  if (!a.rig.left_out.empty()) {
    std::printf("not in the linear analysis (no linear part): %s\n", joined(a.rig.left_out).c_str());
  }
  if (!a.rig.outside_loop.empty()) std::printf("not part of the loop: %s\n", joined(a.rig.outside_loop).c_str());
  for (const auto& sweep : found.sweeps) print_sweep(sweep);
  if (found.map) print_map(*found.map);
  if (found.over) print_amplitudes(*found.over);
}

}  // namespace

void examine_stability(const StabilityOptions& options) {
  const firmware::RigDescription description = examined_rig(options);
  if (options.write_limits) {
    write_limits(description, options.json ? options.json->string() : "");
    return;
  }
  const StabilityResults found = results_of(options, description);
  if (options.report) write_page(*options.report, description, found);
  if (options.json && write_json(options.json, json_of(found, description, options.responses))) return;
  print_results(options.rig, description, found);
  if (options.report) std::printf("report %s\n", options.report->c_str());
}

void add_stability(CLI::App& app, StabilityOptions& options) {
  CLI::App* command = app.add_subcommand(
      "stability", "Delay stability of a hil rig: poles, critical delay, margins, interface location, varying delay");
  command->footer(
      "Ducts: [fdva] open_ducts; the limits hold for every number of ducts that [valves] plan opens.\n"
      "Air spring: a spring with the branch of its heat; its skyhook is part of the loop and not late.");
  command->add_option("--rig", options.rig, "Rig description (TOML), kind = \"hil\"");
  command->add_option("--write-limits", options.write_limits,
                      "Write into this rig description for which loop it was found stable, and the delay that is left: "
                      "[controller] proven and allowed_delay");
  command->add_option("--json", options.json, "Write the result as JSON (- for standard output)");
  command->add_option("--sweep", options.sweeps,
                      "Roots over one variable, for example virtual_damping=0:2000:41; may be given several times");
  command->add_option(
      "--map", options.map,
      "Rightmost root over two variables, for example tau=0:0.03:200,virtual_damping=0:2000:200; a variable "
      "is tau (the whole delay of the loop, half a step of hold included), virtual_damping or a parameter path of the "
      "rig description");
  command->add_option("--report", options.report, "Write all results as one HTML page with figures");
  command->add_option("--amplitude", options.amplitude,
                      "Also analyse the loop with its nonlinear forces at amplitudes of the deflection dz_b up to this "
                      "one [m]: equivalent stiffness and damping, stability, limit cycles");
  command->add_flag("--responses", options.responses, "Add Bode and Nyquist data to the JSON");
  command->add_option("--right-of", options.line, "List the roots with a real part above this value [1/s]")
      ->capture_default_str();
  command->callback([&options] { examine_stability(options); });
}

}  // namespace host_sim
