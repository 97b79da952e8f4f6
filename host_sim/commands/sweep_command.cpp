#include "host_sim/commands/sweep_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/sweep/merge.hpp"
#include "host_sim/sweep/rig_case.hpp"
#include "host_sim/sweep/run_cases.hpp"
#include "host_sim/sweep/sweep_page.hpp"
#include "host_sim/sweep/sweep_plan.hpp"

namespace host_sim {
namespace {

std::string number(std::uint64_t value) { return std::to_string(value); }

nlohmann::ordered_json to_json(const sweep::Merged& merged) {
  nlohmann::ordered_json json{{"cases", merged.cases.count}, {"failed", merged.failed}};
  json["fingerprint"] = merged.cases.fingerprint;
  json["results"] = {merged.json.string(), merged.csv.string()};
  json["numbers"] = nlohmann::ordered_json::object();
  for (const sweep::Spread& s : merged.numbers) {
    json["numbers"][s.name] = {{"mean", s.mean},
                               {"standard_deviation", s.standard_deviation()},
                               {"lowest", s.lowest},
                               {"highest", s.highest},
                               {"cases", s.count}};
  }
  return json;
}

void merge_folder(const std::filesystem::path& folder, const std::filesystem::path& report, const std::string& json) {
  const sweep::Merged merged = sweep::merge_into_files(folder);
  if (!report.empty()) firmware::write_file(report, with_how_made(sweep::sweep_page(merged)));
  if (write_json(json, to_json(merged))) return;
  std::printf("%s cases, none missing, none twice; %s failed\n", number(merged.cases.count).c_str(),
              number(merged.failed).c_str());
  if (merged.failed > 0) std::printf("  %s\n", merged.first_failure.c_str());
  std::printf("  %-28s %12s %12s %12s %12s\n", "", "mean", "std. dev.", "lowest", "highest");
  for (const sweep::Spread& s : merged.numbers) {
    if (s.name.starts_with("lowest_") || s.name.starts_with("highest_")) continue;
    std::printf("  %-28s %12.5g %12.5g %12.5g %12.5g\n", s.name.c_str(), s.mean, s.standard_deviation(), s.lowest,
                s.highest);
  }
  std::printf("results   %s, %s\n", merged.csv.c_str(), merged.json.filename().c_str());
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw firmware::OutputError(folder.string(), "cannot be made", "a folder for the results");
  }
}

}  // namespace

void sweep_command(const SweepOptions& options) {
  if (!options.merge.empty()) {
    if (!options.plan.empty() || !options.out.empty() || !options.shard.empty()) {
      throw firmware::UsageError("--merge takes the folder of the results alone, expected rigtwin sweep --merge DIR");
    }
    merge_folder(options.merge, options.report, options.json);
    return;
  }
  if (options.plan.empty() || options.out.empty()) {
    throw firmware::UsageError("no plan or no folder, expected rigtwin sweep PLAN.toml --out DIR, or --merge DIR");
  }
  const std::optional<sweep::Shard> given =
      options.shard.empty() ? sweep::shard_of_engine(sweep::process_environment) : sweep::parse_shard(options.shard);
  const sweep::Shard shard = given.value_or(sweep::Shard{});
  const std::size_t jobs = options.jobs > 0 ? options.jobs
                           : given          ? 1
                                            : std::max(1U, std::thread::hardware_concurrency());
  const sweep::SweepPlan plan = sweep::read_plan(options.plan);
  make_folder(options.out);
  std::optional<Progress> progress(std::in_place, "sweep");
  const auto tell = [&](const sweep::ShardWork& work) {
    const double all = static_cast<double>(std::max<std::uint64_t>(1, work.cases - work.before));
    progress->show(static_cast<double>(work.now) / all,
                   number(work.before + work.now) + " of " + number(work.cases) + " cases");
  };
  const sweep::ShardWork work = sweep::run_cases(
      plan.cases, shard, options.out, jobs, [&](std::uint64_t id) { return sweep::result_line(plan, id); }, tell);
  progress.reset();
  if (options.json != "-") {
    std::printf("shard %s: %s of %s cases, %s computed now\n", shard.text().c_str(), number(work.cases).c_str(),
                number(plan.cases.count).c_str(), number(work.now).c_str());
  }
  if (!given) {
    merge_folder(options.out, options.report, options.json);
    return;
  }
  const nlohmann::ordered_json json{{"schema", "rigtwin/sweep_shard/1"},
                                    {"shard", shard.text()},
                                    {"cases", work.cases},
                                    {"computed", work.now},
                                    {"all_cases", plan.cases.count}};
  if (!write_json(options.json, json)) {
    std::printf("when all shards are done: rigtwin sweep --merge %s\n", options.out.c_str());
  }
}

void add_sweep(CLI::App& app, SweepOptions& options) {
  CLI::App* command = app.add_subcommand(
      "sweep", "Thousands of simulated runs over roads, speeds and parameters, on one machine or many");
  command->add_option("plan", options.plan, "Plan (TOML): rig, [run], [vary], [draw]");
  command->add_option("--out", options.out, "Folder of the results; what it holds is not computed again");
  command->add_option(
      "--shard", options.shard,
      "i/n: this process computes shard i of n (default: as Slurm, Open MPI, PMI, PBS or Grid Engine say)");
  command->add_option("--jobs", options.jobs, "Cases at once (default: all processors, of a shard 1)")
      ->check(CLI::Range(1, 1024));
  command->add_option("--merge", options.merge, "Folder whose results become results.csv and results.jsonl");
  command->add_option("--report", options.report, "Page to write (HTML): matrix, histograms, numbers");
  add_json_option(*command, options.json, "the summary");
  command->callback([&options] { sweep_command(options); });
}

}  // namespace host_sim
