#include "host_sim/commands/plan_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <optional>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/option_checks.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/identification/common/multisine.hpp"
#include "host_sim/plan/plan_json.hpp"
#include "host_sim/plan/plan_report.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace host_sim {
namespace {

std::vector<model::Channel> channels_of(const std::vector<std::string>& names) {
  std::vector<model::Channel> channels;
  for (const std::string& name : names) {
    const auto channel = model::find_channel(name);
    if (!channel) {
      std::string known;
      for (const auto& c : model::channel_names) known += (known.empty() ? "" : ", ") + std::string(c.name);
      throw firmware::UsageError("--without: unknown channel " + firmware::in_quotes(name) + ", expected one of " +
                                 known);
    }
    if (std::find(channels.begin(), channels.end(), *channel) == channels.end()) channels.push_back(*channel);
  }
  return channels;
}

/// `text` in so many columns, of which each character takes one, whatever its bytes.
std::string right(const std::string& text, std::size_t columns) {
  const auto characters =
      static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
  return std::string(columns - std::min(columns, characters), ' ') + text;
}

void print_effect(const plan::PlannedEffect& effect) {
  const bool any = !effect.subject.values.empty();
  std::printf("%-32s %-15s ", plan::words(effect.subject).c_str(),
              any ? std::string(effect.subject.entry->parameters[effect.parameter].name).c_str() : "");
  if (!effect.why.empty()) {
    std::printf("%s\n", effect.why.c_str());
    return;
  }
  const auto shown = [&](std::optional<double> value) {
    return right(any && value ? plan::value_text(effect, *value) : "-", 18);
  };
  std::printf("%s %s %7.3g σ", shown(effect.shows_at).c_str(), shown(effect.named_at).c_str(),
              effect.at_default.significance);
  if (!effect.taken_for.empty()) {
    std::printf("  %s (%.2g)", effect.taken_for.front().name.c_str(), effect.taken_for.front().left);
  }
  std::printf("\n");
}

void print_plan(const plan::Plan& made) {
  for (const std::string& sentence : plan::sentences(made)) std::printf("%s\n", sentence.c_str());
  const std::vector<plan::Advice> advice = plan::helpful(made);
  for (std::size_t i = 1; i < std::min<std::size_t>(4, advice.size()); ++i) {  // the first is one of the sentences
    std::printf("  %s\n", plan::sentence(advice[i]).c_str());
  }
  std::printf("%-32s %-15s %18s %18s %9s  %s\n", "effect", "parameter", "shows at", "named at", "typical",
              "nearest rival (left beside it, σ of 10)");
  for (const plan::PlannedEffect& effect : made.effects) print_effect(effect);
  std::printf("parameters, half width of the 95 %% interval: nothing else known, beside tolerances\n");
  for (const plan::PlannedParameter& p : made.parameters) {
    std::printf("  %-28s %10.4g  ±%8.3g %%  ±%8.3g %%  %s\n", p.path.c_str(), p.described, 100.0 * p.determined_to,
                100.0 * p.beside_tolerances,
                !p.why.empty() ? p.why.c_str()
                : p.open()     ? "open"
                               : "");
  }
  for (const plan::OpenCombination& open : made.open) {
    std::printf("undetermined: %s (%s)\n", open.combination.c_str(), open.why.c_str());
  }
  for (const std::string& remark : made.remarks) std::printf("%s\n", remark.c_str());
}

}  // namespace

void run_plan(const PlanOptions& options) {
  const std::vector<model::Channel> without = channels_of(options.without);
  const bool only_json = options.json == "-";
  if (!options.json.empty() && !only_json && std::filesystem::path(options.json) == options.report) {
    throw firmware::UsageError("--json and --report name the same file, expected two files");
  }
  const firmware::RigDescription rig = firmware::read_rig(options.rig);
  firmware::refuse_compensation(rig, "plan");
  const firmware::RoadChoice road{options.road, options.speed, options.seed, std::nullopt, std::nullopt};
  plan::Setting setting;
  setting.motion = firmware::excitation(
      rig.rig,
      firmware::motion_over(road, rig, firmware::samples_of(options.duration, rig.sample_rate), read_recording),
      rig.sample_rate);
  identification::scale(setting.motion, options.level);
  setting.without = without;
  setting.seed = options.seed;
  setting.stationary = options.road.starts_with("iso8608:");
  std::optional<Progress> progress(std::in_place, "plan");
  const plan::Plan made = plan::make_plan(rig, std::move(setting),
                                          [&](double share, const std::string& what) { progress->show(share, what); });
  progress.reset();

  std::optional<firmware::OutputFile> json, report;
  if (!options.json.empty() && !only_json) {
    json.emplace(options.json);
    json->write(json_text(plan::to_json(made)));
  }
  if (!options.report.empty()) {
    const std::string over = options.road + " at " + firmware::shortest(options.speed) + " m/s" +
                             (options.level == 1.0 ? "" : ", level " + firmware::shortest(options.level));
    report.emplace(options.report);
    report->write(with_how_made(plan::report_html(made, rig, over)));
  }
  if (json) json->commit();
  if (report) report->commit();
  if (only_json) {
    std::fputs(json_text(plan::to_json(made)).c_str(), stdout);
    return;
  }
  print_plan(made);
}

void add_plan(CLI::App& app, PlanOptions& options) {
  CLI::App* command =
      app.add_subcommand("plan", "Before a recording: which effects and parameters it would show, and what would help");
  command->add_option("--rig", options.rig, "Rig description (TOML)")->required();
  command->add_option("--road", options.road, "iso8608:A … iso8608:H, or a file with t [s] or s [m], and z_r [m]")
      ->capture_default_str();
  command->add_option("--speed", options.speed, "Speed over the road [m/s]")
      ->check(number_within(0.1, 150.0))
      ->capture_default_str();
  command->add_option("--duration", options.duration, "Length of the recording [s]")
      ->check(number_within(5.0, 1e5))
      ->capture_default_str();
  command->add_option("--level", options.level, "Factor of the excitation")
      ->check(number_within(1e-3, 1e3))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of road and sensor noise")
      ->check(whole_64_bit_number())
      ->capture_default_str();
  command->add_option("--without", options.without, "Channels that are not recorded: F_w,zdd_b")->delimiter(',');
  command->add_option("--json", options.json, "Write the plan as JSON (- for standard output)");
  command->add_option("--report", options.report, "Write the plan as a page (HTML)");
  command->callback([&options] { run_plan(options); });
}

}  // namespace host_sim
