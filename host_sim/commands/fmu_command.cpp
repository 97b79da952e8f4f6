#include "host_sim/commands/fmu_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/sha256.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/compensation/compensated_stability.hpp"
#include "host_sim/fmu/archive.hpp"
#include "host_sim/fmu/model_description.hpp"
#include "host_sim/fmu/variables.hpp"

namespace host_sim {
namespace {

void make_fmu(const FmuOptions& options) {
  const firmware::RigDescription rig = firmware::read_rig(options.rig);
  if (rig.rig.kind == model::RigKind::driven_mass) {
    throw firmware::InputError(rig.source, rig.line_of("driven_by"), "an FMU of a mass that a force drives is not made",
                               "a quarter_car, a hil rig or a component_bench that is moved");
  }
  compensation::refuse_unstable_compensation(rig);
  const std::vector<fmu::Binary> binaries = fmu::built_binaries();
  const fmu::Version version = options.fmi == 3 ? fmu::Version::fmi3 : fmu::Version::fmi2;
  const std::string standard = options.fmi == 3 ? "3.0" : "2.0";
  fmu::write_fmu(options.out, rig, binaries, version);

  const std::string guid = firmware::sha256(fmu::description_in_fmu(rig));
  const fmu::Variables variables(rig);
  const auto count = [&](fmu::Causality causality) {
    return std::ranges::count(variables.list(), causality, &fmu::Variable::causality);
  };
  std::vector<std::string> platforms;
  std::string machines;
  for (const fmu::Binary& binary : binaries) {
    platforms.push_back(fmu::folder_in_fmu(binary, version));
    machines += (machines.empty() ? "" : ", ") + platforms.back();
  }
  if (!options.json.empty()) {
    const nlohmann::ordered_json json{{"fmu", options.out},
                                      {"fmi_version", standard},
                                      {"guid", guid},
                                      {"platforms", platforms},
                                      {"step_size", rig.period()},
                                      {"variables",
                                       {{"parameters", count(fmu::Causality::parameter)},
                                        {"inputs", count(fmu::Causality::input)},
                                        {"outputs", count(fmu::Causality::output)}}}};
    if (write_json(options.json, json)) return;
  }
  std::printf("%s: FMI %s co-simulation, %s, step %.6g s, for %s\n", options.out.c_str(), standard.c_str(),
              std::string(model::name(rig.rig.kind)).c_str(), rig.period(), machines.c_str());
  std::printf("  guid %s\n  %td parameters, %td inputs, %td outputs\n", guid.c_str(), count(fmu::Causality::parameter),
              count(fmu::Causality::input), count(fmu::Causality::output));
  for (const std::string& preset : fmu::missing_presets(binaries)) {
    std::printf(
        "  not for %s: its library was not built (cmake --preset %s; cmake --build build/%s --target rigtwin_fmu)\n",
        preset.c_str(), preset.c_str(), preset.c_str());
  }
}

}  // namespace

void add_fmu(CLI::App& app, FmuOptions& options) {
  CLI::App* command = app.add_subcommand(
      "fmu", "Write a rig as an FMU for Linux and Windows: FMI 2.0 or 3.0 for co-simulation, with the same step");
  command->add_option("--rig", options.rig, "Rig description (TOML)")->required();
  command->add_option("--out", options.out, "FMU to write")->required();
  command->add_option("--fmi", options.fmi, "Version of FMI: 2 or 3")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  command->add_option("--json", options.json, "Write what was made as JSON (- for standard output)");
  command->callback([&options] { make_fmu(options); });
}

}  // namespace host_sim
