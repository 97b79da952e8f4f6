#include "host_sim/commands/effects_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/commands/common/json_output.hpp"

namespace host_sim {

void list_effects(const EffectsOptions& options) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::string lines;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    nlohmann::ordered_json one{{"name", entry.name},
                               {"subsystem", model::name(entry.subsystem)},
                               {"equation", entry.equation},
                               {"shows", entry.shows},
                               {"parameters", nlohmann::ordered_json::array()}};
    std::string parameters;
    for (const model::EffectParameter& p : entry.parameters) {
      one["parameters"].push_back({{"name", p.name}, {"unit", p.unit}});
      const bool has_unit = p.unit != "1";
      parameters +=
          (parameters.empty() ? "" : ", ") + std::string(p.name) + (has_unit ? " [" + std::string(p.unit) + "]" : "");
    }
    list.push_back(std::move(one));
    char head[96];
    std::snprintf(head, sizeof head, "%-24s %-13s ", std::string(entry.name).c_str(),
                  std::string(model::name(entry.subsystem)).c_str());
    lines += head + parameters + "\n" + std::string(26, ' ') + std::string(entry.equation) + "\n";
  }
  if (write_json(options.json, {{"effects", std::move(list)}})) return;
  std::printf("%s%s", lines.c_str(), "One of them in full: rigtwin diagnose --explain NAME\n");
}

void add_effects(CLI::App& app, EffectsOptions& options) {
  CLI::App* command = app.add_subcommand("effects", "List the effects of the catalogue: place, parameters, equation");
  add_json_option(*command, options.json, "the list");
  command->callback([&options] { list_effects(options); });
}

}  // namespace host_sim
