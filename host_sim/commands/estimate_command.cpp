#include "host_sim/commands/estimate_command.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/estimation/run_filter.hpp"
#include "host_sim/estimation/wheel_load_report.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace host_sim {
namespace {

using estimation::Estimate;
using estimation::WheelLoad;
using nlohmann::ordered_json;

ordered_json json_of(const Estimate& estimate, const std::vector<WheelLoad>& loads) {
  ordered_json json;
  ordered_json channels = ordered_json::object();
  for (const auto& c : estimate.channels) {
    channels[std::string(model::name(c.channel))] = {
        {"samples", c.count}, {"innovation_rms", c.rms}, {"correlation_of_neighbours", c.one_late}};
  }
  json["channels"] = std::move(channels);
  json["nis"] = estimate.nis;
  json["expected_sigma"] = {{"F_w", estimate.sigma_wheel_load}, {"v_rel", estimate.sigma_velocity}};
  const std::optional<bool> wrong = estimate.model_wrong();
  json["model_wrong"] = wrong ? ordered_json(*wrong) : ordered_json(nullptr);  // null: not judged
  json["alarms"] = estimate.alarms;
  json["blocks"] = estimate.blocks;
  json["road_otherwise"] = estimate.wide_share();
  ordered_json sources = ordered_json::object();
  for (const WheelLoad& load : loads) {
    if (load.error_rms) sources[load.name] = {{"error_rms", *load.error_rms}};
  }
  json["wheel_load"] = std::move(sources);
  return json;
}

void print(const EstimateOptions& options, const Estimate& estimate, const std::vector<WheelLoad>& loads) {
  std::printf("%s over %s: NIS %.3f (1 for a right model), %zu samples too old\n", options.rig.c_str(),
              options.data.c_str(), estimate.nis, estimate.too_old);
  std::printf("  %-8s %10s %12s %12s\n", "channel", "samples", "innovation", "neighbours");
  for (const auto& c : estimate.channels) {
    std::printf("  %-8s %10zu %12.4f %12.4f\n", std::string(model::name(c.channel)).c_str(), c.count, c.rms,
                c.one_late);
  }
  std::printf("  expected standard deviation: F_w %.3g N, velocity of the deflection %.3g m/s\n",
              estimate.sigma_wheel_load, estimate.sigma_velocity);
  for (const WheelLoad& load : loads) {
    if (load.error_rms) std::printf("  wheel load, %-12s error %.4g N rms\n", load.name.c_str(), *load.error_rms);
  }
  std::printf("%s\n", estimation::sentence(estimate).c_str());
}

}  // namespace

void estimate(const EstimateOptions& options) {
  refuse_unknown_ending(options.out);
  const firmware::RigDescription description = firmware::read_rig(options.rig);
  const std::vector<firmware::Recording> parts =
      read_parts(options.data, description.channels, description.sample_rate);
  const auto ages = estimation::recorded_ages(options.data, description, parts);
  if (!parts.front().remark.empty() && options.json != "-") std::printf("%s\n", parts.front().remark.c_str());
  std::optional<firmware::Recording> truth;
  if (!options.truth.empty()) truth = read_recording(options.truth, description.channels, description.sample_rate);
  if (parts.size() > 1 && (truth || !options.report.empty())) {
    throw firmware::InputError(options.data, 0, "the recording has gaps beyond 20 ms",
                               "a recording without them for --truth and --report");
  }
  const Estimate result = estimation::run_filter(description, parts, ages);
  std::vector<WheelLoad> loads;
  if (parts.size() == 1) {
    loads = estimation::wheel_loads(description, parts.front(), result, truth ? &*truth : nullptr);
  }
  std::string page;
  if (!options.report.empty()) {
    page = with_how_made(estimation::report_page(description, parts.front(), result, loads, truth ? &*truth : nullptr));
  }
  firmware::Recording out;
  out.sample_period = parts.front().sample_period;
  out.time = result.time;
  out.extra = result.columns;
  out.comments = {"rigtwin estimate: Kalman filter of " + options.rig + " over " + options.data,
                  "estimates, no measurements: not for diagnose"};
  write_recording(options.out, out);
  if (!page.empty()) firmware::write_file(options.report, page);
  if (!write_json(options.json, json_of(result, loads))) print(options, result, loads);
}

void add_estimate(CLI::App& app, EstimateOptions& options) {
  CLI::App* command = app.add_subcommand(
      "estimate", "Run the controller's Kalman filter over a recording: states, wheel load, is the model right?");
  command->footer(
      "Ducts: columns duct_1 ... of the recording, else [fdva] open_ducts. Air spring, lever and laws from tables "
      "count "
      "as springs and dampers over the road of [estimator]; the force of a skyhook is refused.");
  command->add_option("--rig", options.rig, "Rig description, a quarter_car with [noise]")->required();
  command->add_option("--data", options.data, "Recording: CSV or MATLAB")->required();
  command->add_option("--out", options.out, "Estimates to write: CSV, or MATLAB if the name ends in .mat")->required();
  command->add_option("--truth", options.truth, "Recording of the same run whose F_w is right, to compare with");
  command->add_option("--report", options.report, "HTML page: wheel load by tyre deflection, sensor and filter");
  add_json_option(*command, options.json, "the result");
  command->callback([&options] { estimate(options); });
}

}  // namespace host_sim
