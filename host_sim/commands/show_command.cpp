#include "host_sim/commands/show_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/recorded_as.hpp"
#include "host_sim/comparison/comparison.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/show/recording_page.hpp"

namespace host_sim {
namespace {

nlohmann::ordered_json json_of(const std::vector<show::Shown>& shown) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const show::Shown& one : shown) {
    nlohmann::ordered_json channels = nlohmann::ordered_json::array();
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      if (!one.recording.channels[c].empty()) channels.push_back(model::channel_names[c].name);
    }
    list.push_back({{"name", one.name},
                    {"samples", one.recording.size()},
                    {"sample_rate", 1.0 / one.recording.sample_period},
                    {"channels", std::move(channels)},
                    {"ignored_columns", one.recording.ignored_columns},
                    {"remark", one.recording.remark}});
  }
  return {{"recordings", std::move(list)}};
}

}  // namespace

void show_recordings(const ShowOptions& options) {
  std::vector<firmware::RigDescription> rigs;
  for (const std::string& rig : options.rigs) {
    rigs.push_back(firmware::read_rig(rig));
    firmware::refuse_compensation(rigs.back(), "show");
  }
  const firmware::RigDescription* const first = rigs.empty() ? nullptr : &rigs.front();
  std::vector<show::Shown> shown;
  for (const auto& file : options.data) {
    auto parts =
        first == nullptr ? read_parts(file) : read_parts(file, first->channels, first->sample_rate, first->rig.kind);
    const std::size_t count = parts.size();
    for (std::size_t i = 0; i < count; ++i) {
      std::string name = file.filename().string();
      if (count > 1) name += ", part " + std::to_string(i + 1);
      shown.push_back({std::move(name), std::move(parts[i]), {}});
    }
  }
  for (show::Shown& one : shown) {
    for (std::size_t r = 0; r < rigs.size(); ++r) {
      const ComparedRecording compared(rigs[r], one.recording, StartChoice::automatic, recorded_as(rigs[r]));
      one.models.push_back(
          {std::filesystem::path(options.rigs[r]).filename().string(), compared.simulate(rigs[r].rig)});
    }
  }
  firmware::write_file(options.report, with_how_made(show::recordings_page(shown)));
  if (write_json(options.json, json_of(shown))) return;
  std::printf("%s\nreport %s\n", show::sentence(shown).c_str(), options.report.c_str());
}

void add_show(CLI::App& app, ShowOptions& options) {
  CLI::App* command = app.add_subcommand(
      "show", "Show recordings as a page: traces, spectra, responses, statistics; with --rig the model behind them");
  command->add_option("data", options.data, "Recordings in any format that rigtwin import reads")->required();
  command->add_option("--rig", options.rigs,
                      "Rig description (TOML) whose simulation of the recording lies behind it; may be given several "
                      "times: the first one's [channels] count");
  command->add_option("--report", options.report, "Page to write (HTML)")->required();
  add_json_option(*command, options.json, "what was read");
  command->callback([&options] { show_recordings(options); });
}

}  // namespace host_sim
