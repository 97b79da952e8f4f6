#include "host_sim/commands/transfer_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/option_checks.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/transfer/report/transfer_json.hpp"
#include "host_sim/transfer/report/transfer_report.hpp"
#include "host_sim/transfer/report/wording.hpp"
#include "host_sim/transfer/transfer.hpp"

namespace host_sim {
namespace {

namespace fs = std::filesystem;

std::vector<identification::Record> records_of(const std::vector<fs::path>& files,
                                               const firmware::RigDescription& rig) {
  std::vector<identification::Record> records;
  for (const fs::path& file : files) {
    for (firmware::Recording& part : read_parts(file, rig.channels, rig.sample_rate)) {
      records.push_back({std::move(part), identification::Use::shared});
    }
  }
  return records;
}

void prepare_out(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (fs::is_directory(folder, error)) return;
  throw firmware::OutputError(folder.string(), "is not a folder and cannot become one", "a folder that may be written");
}

void print_transfer(const transfer::Transfer& t, const fs::path& folder) {
  std::printf("%s\n", transfer::verdict_text(t).c_str());
  std::printf("%-26s %-6s %10s %23s %23s %10s\n", "quantity", "unit", "median", "50 % band", "95 % band", "measured");
  for (std::size_t q = 0; q < transfer::quantity_count; ++q) {
    const transfer::Bands b = t.prediction.quantity(static_cast<transfer::Quantity>(q));
    std::printf("%-26s %-6s %10.5g %10.5g … %10.5g %10.5g … %10.5g", std::string(transfer::quantity_names[q]).c_str(),
                std::string(transfer::quantity_units[q]).c_str(), b.median, b.low50, b.high50, b.low95, b.high95);
    if (t.validation) std::printf(" %10.5g", t.validation->measured.quantity[q]);
    std::printf("\n");
  }
  if (t.naive && t.naive->validation) {
    std::printf("with the first rig's own effects ignored %.0f %% of the lines would lie in the 95 %% band\n",
                100.0 * t.naive->validation->coverage95);
  }
  for (const transfer::SharedValue& shared : t.both.shared) std::printf("%s\n", transfer::words(shared).c_str());
  for (std::size_t i = 0; i < std::min<std::size_t>(3, t.next.list.size()); ++i) {
    std::printf("next on the first rig: %s\n", transfer::words(t.next.list[i]).c_str());
  }
  std::printf("posterior: %zu draws, R-hat %.4f, %.0f effective draws\n", t.posterior.draws, t.posterior.largest_rhat,
              t.posterior.fewest_effective);
  for (const std::string& warning : t.posterior.warnings) std::printf("warning: %s\n", warning.c_str());
  for (const std::string& remark : t.remarks) std::printf("%s\n", remark.c_str());
  std::printf("%s: transfer.json, report.html\n", folder.string().c_str());
}

}  // namespace

void run_transfer(const TransferOptions& options) {
  transfer::TransferInput input;
  input.from = firmware::read_rig(options.from);
  input.to = firmware::read_rig(options.to);
  for (const auto* rig : {&input.from, &input.to}) firmware::refuse_compensation(*rig, "transfer");
  input.first = records_of(options.data, input.from);
  input.second = records_of(options.measured, input.to);
  input.draws = options.draws;
  input.seed = options.seed;
  if (options.measured.empty()) {
    const firmware::RoadChoice road{options.road, options.speed, options.seed, std::nullopt, std::nullopt};
    input.road = firmware::motion_over(road, input.to, firmware::samples_of(options.duration, input.to.sample_rate),
                                       read_recording);
  }
  prepare_out(options.out);
  const firmware::RigDescription from = input.from, to = input.to;
  std::optional<Progress> progress(std::in_place, "transfer");
  const transfer::Transfer found = transfer::transfer_component(
      std::move(input), [&](double share, const std::string& what) { progress->show(share, what); });
  progress.reset();

  // Both files or none: each is written under a temporary name first.
  firmware::OutputFile json(options.out / "transfer.json"), report(options.out / "report.html");
  const HowMade how_made;
  json.write(how_made.json(transfer::to_json(found)));
  report.write(how_made.in(transfer::report_html(found, from, to)));
  json.commit();
  report.commit();
  if (write_json(options.json, transfer::to_json(found))) return;
  print_transfer(found, options.out);
}

void add_transfer(CLI::App& app, TransferOptions& options) {
  CLI::App* command = app.add_subcommand(
      "transfer", "A component learned on one rig predicts another, with bands; recordings say whether they hold");
  command->add_option("--from", options.from, "Rig description of the first rig (TOML)")->required();
  command->add_option("--data", options.data, "Recording of the first rig; may be given several times")->required();
  command->add_option("--to", options.to, "Rig description of the second rig, a quarter_car (TOML)")->required();
  command->add_option("--measured", options.measured,
                      "Recording of the second rig, for validation; may be given several times");
  command
      ->add_option("--road", options.road,
                   "Without --measured: iso8608:A … iso8608:H, or a file with t [s] or s [m], and z_r [m]")
      ->capture_default_str();
  command->add_option("--speed", options.speed, "Speed over the road [m/s]")
      ->check(number_within(0.1, 150.0))
      ->capture_default_str();
  command->add_option("--duration", options.duration, "Length of the road [s]")
      ->check(number_within(5.0, 1e4))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of road and draws")
      ->check(whole_64_bit_number())
      ->capture_default_str();
  command->add_option("--draws", options.draws, "Draws of the sampler")
      ->check(CLI::Range(200, 1000000))
      ->capture_default_str();
  command->add_option("--out", options.out, "Folder for transfer.json and report.html")->required();
  add_json_option(*command, options.json, "transfer.json here, too,");
  command->callback([&options] { run_transfer(options); });
}

}  // namespace host_sim
