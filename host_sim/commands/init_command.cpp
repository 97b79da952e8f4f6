#include "host_sim/commands/init_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/option_checks.hpp"

namespace host_sim {
namespace {

constexpr std::string_view kinds = "quarter_car, hil or component_bench";
constexpr double driven_mass = 10.0;        // [kg] of a template: on the spring below it has 5 Hz
constexpr double spring_below_mass = 10e3;  // [N/m]
constexpr double damper_below_mass = 30.0;  // [N s/m], 5 % of critical

/// A line of an answer on the terminal; empty: the usual value.
std::string answer_to(const std::string& question) {
  std::fprintf(stderr, "%s ", question.c_str());
  std::string line;
  if (!std::getline(std::cin, line)) throw firmware::UsageError("standard input has ended, expected an answer");
  return line;
}

/// The value of an option, else an answer on a terminal, else the usual value.
double value_of(const std::optional<double>& option, const std::string& what, const std::string& unit, double usual) {
  if (option) return *option;
  if (::isatty(STDIN_FILENO) == 0) return usual;
  for (;;) {
    const std::string line = answer_to(what + " [" + unit + "], usual " + firmware::shortest(usual) + ":");
    if (line.empty()) return usual;
    try {
      std::size_t end = 0;
      const double value = std::stod(line, &end);
      if (end == line.size()) return value;
    } catch (const std::logic_error&) {  // asked again
    }
    std::fprintf(stderr, "  '%s' is no number\n", line.c_str());
  }
}

std::string entry(std::string_view key, double value, std::string_view comment) {
  char number[40];
  std::snprintf(number, sizeof number, "%.12g", value);
  std::string line = std::string(key) + " = " + number;
  if (line.find_first_of(".e", line.find('=')) == std::string::npos) line += ".0";
  line.resize(std::max<std::size_t>(line.size() + 1, 34), ' ');
  return line + "# " + std::string(comment) + "\n";
}

constexpr std::string_view absorber = R"(
[fdva]                            # fluid dynamic vibration absorber; leave this table out for a plain spring and damper
piston_area = 30e-4               # m²
duct_diameter = 12e-3             # m
duct_length = 0.6361571127        # m
oil_density = 860.0               # kg/m³
oil_viscosity = 32e-6             # m²/s, kinematic, at working temperature
minor_loss = 1.5                  # sum of the loss coefficients of inlet, bends and outlet
coupling_stiffness = 55e3         # N/m, of the spring between piston and body
ducts = 6
open_ducts = 2
)";

/// The tables that may be left out, as comments; examples name channels that the kind of rig has (`force`), and one
/// that a recorder names otherwise (`renamed`).
std::string optional_parts(std::string_view force, std::string_view renamed) {
  const std::string f(force);
  return R"(
# How far a parameter may be from its value above, relative, as a hard bound. diagnose fits these; what is not listed is exact.
# Take them from the data sheet, or from the scatter and the calibration of a measurement of your own. The number below is a place to
# write, not a recommendation. Too narrow: diagnose explains the rest by effects. Too wide: a poor record leaves more open.
# [tolerance]
# "suspension.stiffness" = 0.03     # replace by yours

# rms of each sensor's noise, in the channel's unit. Record the rig at rest and take the rms of what is left; a channel that is not
# listed has unknown noise, which diagnose estimates. rigtwin channels lists the channels with sign and unit.
# [noise]
# )" + f +
         R"( = 10.0)" + std::string(30 - force.size(), ' ') +
         R"(# replace by yours

# Measuring range; a sample at or beyond it is clipped and not used.
# [range]
# )" + f +
         R"( = [-10000.0, 10000.0])" + std::string(16 - force.size(), ' ') + R"(# replace by yours

# Only if recordings use other names, units or signs: value in SI = scale × column + offset.
# [channels]
# )" + std::string(renamed) +
         R"(

# Effects that are known already, by the names of the catalogue (rigtwin effects lists them).
# [effects.coulomb_friction]
# force = 20.0
)";
}

std::string description_of(const InitOptions& options, const std::string& kind) {
  const bool bench = kind == "component_bench", hil = kind == "hil";
  std::string text = "# A rig description for rigtwin. SI units throughout; an unknown key is an error.\nkind = \"" +
                     kind + "\"\n" +
                     entry("sample_rate", value_of(options.sample_rate, "Sample rate", "Hz", 1000.0),
                           "Hz, of the control loop and of its recordings");
  const bool driven = bench && options.driven_by == "force";
  if (driven) {
    text += "driven_by = \"force\"                     # F is the input; x_act and zdd_b, or one of them, answer\n";
    text += "\n[body]\n" + entry("mass", value_of(options.body, "Mass", "kg", driven_mass),
                                 "kg, all that moves: payload, armature, a third of the spring");
  }
  if (!bench) {
    const std::string computed = hil ? "kg, computed: exact" : "kg, sprung mass on this wheel";
    text += "\n[body]\n" + entry("mass", value_of(options.body, "Body mass", "kg", 290.0), computed);
    text += "[wheel]\n" + entry("mass", value_of(options.wheel, "Wheel mass", "kg", 40.0),
                                hil ? "kg, computed: exact" : "kg, with hub, brake and half of the links");
    text += "[tyre]\n" +
            entry("stiffness", value_of(options.tyre_stiffness, "Tyre stiffness", "N/m", 200e3),
                  "N/m, at working pressure and load") +
            entry("damping", value_of(options.tyre_damping, "Tyre damping", "N s/m", 100.0), "N s/m");
  }
  text +=
      std::string(bench && !driven ? "\n" : "") + "[suspension]\n" +
      entry("stiffness",
            value_of(options.suspension_stiffness, "Suspension stiffness", "N/m", driven ? spring_below_mass : 31500.0),
            bench ? "N/m, of the component's spring" : "N/m, of the main spring, at the wheel") +
      entry("damping",
            value_of(options.suspension_damping, "Suspension damping", "N s/m",
                     driven ? damper_below_mass
                     : hil  ? 0.0
                            : 1140.0),
            "N s/m, linear part");
  if (hil) {
    text +=
        "[machine]\n" + entry("virtual_damping", value_of(options.virtual_damping, "Virtual damping", "N s/m", 1140.0),
                              "N s/m, computed beside the component; rigtwin stability says how much is needed");
  }
  if (options.fdva) text += absorber;
  if (bench) return text + optional_parts("F", "x_act = { column = \"Stroke mm\", scale = 1e-3 }");
  return text + (hil ? optional_parts("F", "F = { column = \"Load kN\", scale = 1e3 }")
                     : optional_parts("F_w", "z_r = { column = \"Road mm\", scale = 1e-3 }"));
}

void init(const InitOptions& options) {
  if (std::filesystem::exists(options.out) && std::filesystem::is_regular_file(options.out)) {
    throw firmware::OutputError(options.out.string(), "is there already", "the name of a new file");
  }
  std::string kind = options.kind;
  if (kind.empty()) {
    if (::isatty(STDIN_FILENO) == 0) throw firmware::UsageError("--kind is missing, expected " + std::string(kinds));
    kind = answer_to("Kind of rig (" + std::string(kinds) + "), usual quarter_car:");
    if (kind.empty()) kind = "quarter_car";
  }
  if (options.driven_by == "force" && kind != "component_bench") {
    throw firmware::UsageError("--driven-by force: is for a component_bench, expected --kind component_bench");
  }
  if (kind != "quarter_car" && kind != "hil" && kind != "component_bench") {
    throw firmware::UsageError("unknown kind " + firmware::in_quotes(kind) + ", expected " + std::string(kinds));
  }
  const std::string text = description_of(options, kind);
  (void)firmware::parse_rig(text,
                            options.out.string());  // numbers that cannot be a rig are refused before they are written
  firmware::write_file(options.out, text);
  if (write_json(options.json, {{"rig", options.out.string()}, {"kind", kind}})) return;
  std::printf("%s: a %s; next: rigtwin simulate --rig %s --out run.csv\n", options.out.c_str(), kind.c_str(),
              options.out.c_str());
}

}  // namespace

void add_init(CLI::App& app, InitOptions& options) {
  CLI::App* command = app.add_subcommand("init", "Write a first rig description with comments; asks on a terminal");
  command->add_option("--out", options.out, "Rig description to write (TOML); never replaces a file")
      ->capture_default_str();
  command->add_option("--kind", options.kind, std::string(kinds));
  const auto number = [command](const char* name, std::optional<double>& value, const char* help) {
    command->add_option(name, value, help)->check(number_within(0.0, 1e12));
  };
  number("--sample-rate", options.sample_rate, "Sample rate [Hz] (default: 1000)");
  number("--body-mass", options.body, "Body mass [kg] (default: 290)");
  number("--wheel-mass", options.wheel, "Wheel mass [kg] (default: 40)");
  number("--tyre-stiffness", options.tyre_stiffness, "Tyre stiffness [N/m] (default: 200000)");
  number("--tyre-damping", options.tyre_damping, "Tyre damping [N s/m] (default: 100)");
  number("--suspension-stiffness", options.suspension_stiffness, "Suspension stiffness [N/m] (default: 31500)");
  number("--suspension-damping", options.suspension_damping, "Suspension damping [N s/m] (default: 1140; hil: 0)");
  number("--virtual-damping", options.virtual_damping, "hil: virtual damping [N s/m] (default: 1140)");
  command->add_option("--driven-by", options.driven_by, "component_bench: motion (usual), or force on a mass")
      ->check(CLI::IsMember({"motion", "force"}));
  command->add_flag("--fdva", options.fdva, "With the paper's fluid dynamic vibration absorber");
  command->add_option("--json", options.json, "Write what was made as JSON (- for standard output)");
  command->callback([&options] { init(options); });
}

}  // namespace host_sim
