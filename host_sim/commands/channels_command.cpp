#include "host_sim/commands/channels_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/report/channel_glossary.hpp"

namespace host_sim {

void list_channels(const ChannelsOptions& options) {
  const auto* const known =
      std::find(model::rig_kind_names.begin(), model::rig_kind_names.end(), std::string_view(options.kind));
  if (!options.kind.empty() && known == model::rig_kind_names.end()) {
    throw firmware::UsageError("--kind: is " + firmware::in_quotes(options.kind) +
                               ", expected quarter_car, hil or component_bench");
  }
  nlohmann::ordered_json channels = nlohmann::ordered_json::array();
  std::string lines;
  for (const report::ChannelMeaning& meaning : report::channel_glossary()) {
    std::string rigs;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < model::rig_kind_names.size(); ++k) {
      if (!meaning.of(static_cast<model::RigKind>(k))) continue;
      rigs += (rigs.empty() ? "" : ", ") + std::string(model::rig_kind_names[k]);
      list.push_back(model::rig_kind_names[k]);
    }
    if (!options.kind.empty() && !meaning.of(static_cast<model::RigKind>(known - model::rig_kind_names.begin()))) {
      continue;
    }
    const std::string name(model::name(meaning.channel)), unit(model::unit(meaning.channel));
    channels.push_back({{"name", name},
                        {"unit", unit},
                        {"meaning", meaning.meaning},
                        {"positive", meaning.positive},
                        {"rigs", std::move(list)}});
    char line[200];
    const int wide = unit == "m/s²" ? 6 : 5;  // ² has two bytes
    std::snprintf(line, sizeof line, "%-6s %-*s %-56s %-15s %s\n", name.c_str(), wide, unit.c_str(),
                  std::string(meaning.meaning).c_str(), std::string(meaning.positive).c_str(), rigs.c_str());
    lines += line;
  }
  if (write_json(options.json, {{"channels", std::move(channels)}})) return;
  std::printf("%-6s %-5s %-56s %-15s %s\n%s\n%s", "name", "unit", "meaning", "positive", "rigs", lines.c_str(),
              std::string(report::channel_picture()).c_str());
}

void add_channels(CLI::App& app, ChannelsOptions& options) {
  CLI::App* command = app.add_subcommand("channels", "List the channels of a recording: sign, unit, rigs, a picture");
  command->add_option("--kind", options.kind, "Only those of a quarter_car, hil or component_bench");
  add_json_option(*command, options.json, "the list");
  command->callback([&options] { list_channels(options); });
}

}  // namespace host_sim
