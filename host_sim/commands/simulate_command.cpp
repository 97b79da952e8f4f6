#include "host_sim/commands/simulate_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/run_stopped.hpp"
#include "firmware/description/version.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/closed_loop/trace.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/option_checks.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/compensation/compensated_stability.hpp"
#include "host_sim/recording_files/mapped_memory.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/show/recording_page.hpp"
#include "host_sim/signal/summary.hpp"

namespace host_sim {
namespace {

/// A trip in one line: reason, channel, value, limit, time.
std::string describe(const firmware::Trip& trip) {
  using firmware::Reason;
  std::string text(firmware::name(trip.reason));
  if (trip.channel) text += " of " + std::string(model::name(*trip.channel));
  const bool in_a_row = trip.reason == Reason::sample_missing || trip.reason == Reason::sample_not_finite ||
                        trip.reason == Reason::sample_clipped || trip.reason == Reason::sample_stale;
  std::string unit(trip.channel ? model::unit(*trip.channel) : "");
  if (trip.reason == Reason::speed) unit = "m/s";
  if (trip.reason == Reason::stroke) unit = "m";
  if (trip.reason == Reason::energy) unit = "J fed per J dissipated";
  char numbers[128];
  std::snprintf(
      numbers, sizeof numbers,
      in_a_row ? ": last %.4g %s, %.0f times in a row, at t = %.4f s" : ": %.4g %s, limit %.4g, at t = %.4f s",
      trip.value, unit.c_str(), trip.limit, trip.time.seconds());
  return text + numbers;
}

void print_channels(const firmware::Recording& recording) {
  std::printf("  %-6s %-5s %12s %12s %12s\n", "", "unit", "rms", "lowest", "highest");
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const auto& column = recording.channels[i];
    if (column.empty()) continue;
    const auto [rms, lowest, highest] = summarise(column);
    const std::string unit(model::channel_names[i].unit);
    const int width = unit.find("²") != std::string::npos ? 6 : 5;  // ² is two bytes
    std::printf("  %-6s %-*s %12.5g %12.5g %12.5g\n", std::string(model::channel_names[i].name).c_str(), width,
                unit.c_str(), rms, lowest, highest);
  }
}

nlohmann::ordered_json json_of(const SimulateOptions& options, const Run& run, const firmware::RigDescription& rig) {
  nlohmann::ordered_json json{{"recording", options.out.string()},
                              {"kind", model::name(rig.rig.kind)},
                              {"samples", run.recording.size()},
                              {"sample_rate", rig.sample_rate},
                              {"road", options.road},
                              {"speed", options.speed},
                              {"seed", options.seed},
                              {"trace", hexadecimal(trace_hash(run.recording))},
                              {"trip", nullptr},
                              {"limited_commands", run.counters.limited_commands}};
  if (firmware::is_fault(run.trip.reason)) {
    json["trip"] = {
        {"reason", firmware::name(run.trip.reason)}, {"time", run.trip.time.seconds()}, {"text", describe(run.trip)}};
  }
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const auto& column = run.recording.channels[i];
    if (column.empty()) continue;
    const auto [rms, lowest, highest] = summarise(column);
    json["channels"][std::string(model::channel_names[i].name)] = {
        {"unit", model::channel_names[i].unit}, {"rms", rms}, {"lowest", lowest}, {"highest", highest}};
  }
  return json;
}

}  // namespace

void simulate(const SimulateOptions& options) {
  refuse_unknown_ending(options.out);
  keep_large_blocks_in_files();
  const firmware::RigDescription rig = firmware::read_rig(options.rig);
  compensation::refuse_unstable_compensation(rig);
  const std::size_t samples = firmware::samples_of(options.duration, rig.sample_rate);
  const firmware::RoadChoice road{options.road, options.speed, options.seed, options.bandwidth, options.cut_off};
  const firmware::FootPointMotion motion = firmware::run_motion(road, rig, samples, read_recording);

  Progress progress("simulate");
  RunOptions run_options;
  run_options.seed = options.seed;
  run_options.noise =
      options.no_noise ? firmware::SimulatedRig::Noise::none : firmware::SimulatedRig::Noise::as_described;
  run_options.progress = [&progress](double share) { progress.show(share); };
  Run run = run_closed_loop(rig, motion, run_options);
  if (run.recording.size() == 0) {
    throw firmware::RunStopped("the firmware stopped the run before its first sample: " + describe(run.trip));
  }

  const bool stopped = firmware::is_fault(run.trip.reason);
  const std::string reason = "the firmware stopped the run: " + describe(run.trip);
  if (stopped && !options.allow_stop) {
    throw firmware::RunStopped(reason + ", of " + firmware::shortest(options.duration) +
                               " s; nothing was written (--allow-stop keeps what there is)");
  }
  if (stopped) std::fprintf(stderr, "rigtwin: %s\n", reason.c_str());

  run.recording.comments.push_back("rigtwin " + std::string(firmware::version) +
                                   " simulate: " + std::string(model::name(rig.rig.kind)) + ", " + options.road + ", " +
                                   firmware::shortest(options.speed) + " m/s, seed " + std::to_string(options.seed));
  progress.end();
  write_recording(options.out, run.recording);
  if (!options.report.empty()) {
    const std::string page = show::recordings_page({{options.out.filename().string(), run.recording, {}}});
    firmware::write_file(options.report, with_how_made(page));
  }
  if (!options.json.empty() && write_json(options.json, json_of(options, run, rig))) return;
  if (options.out == "-") return;  // nothing else on standard output

  std::printf("%s: %s, %.6g s at %.6g Hz over %s at %.4g m/s, seed %llu\n", options.rig.c_str(),
              std::string(model::name(rig.rig.kind)).c_str(),
              static_cast<double>(run.recording.size()) / rig.sample_rate, rig.sample_rate, options.road.c_str(),
              options.speed, static_cast<unsigned long long>(options.seed));
  print_channels(run.recording);
  if (run.counters.limited_commands > 0) {
    std::printf("  %llu commands were slowed down to the speed limit of %.3g m/s\n",
                static_cast<unsigned long long>(run.counters.limited_commands), rig.controller.speed);
  }
  std::printf("trace     %s\nrecording %s (%zu samples)\n", hexadecimal(trace_hash(run.recording)).c_str(),
              options.out.c_str(), run.recording.size());
}

void add_simulate(CLI::App& app, SimulateOptions& options) {
  CLI::App* command = app.add_subcommand("simulate", "Drive a simulated rig over a road through the firmware");
  command->footer(
      "Ducts: [fdva] open_ducts, or switched by [valves] plan = [{ t, open }] or policy = \"force_velocity\" or "
      "\"rollout\" (with [estimator] kind = \"kalman\"); the recording has duct_1 ...\n"
      "Air spring: [air_spring] pressure, area, volume; skyhook moves its area, levelling_rate its height. Without a "
      "spring beside it, pressure times area times the [lever] ratio at rest must carry the body.");
  command->add_option("--rig", options.rig, "Rig description (TOML)")->required();
  command
      ->add_option("--out", options.out,
                   "Recording to write; the ending decides: .csv, .mat, .mf4, .rsp, .mcap, .uff, .tsv and .de.csv "
                   "(spreadsheets); - for CSV on standard output")
      ->required();
  command
      ->add_option("--road", options.road,
                   "iso8608:A … iso8608:H, or a file with t [s] or s [m], and z_r [m] or the command (z_cmd, x_cmd; "
                   "of a rig driven by force F [N])")
      ->capture_default_str();
  command->add_option("--speed", options.speed, "Speed over the road [m/s]")
      ->check(number_within(0.1, 150.0))
      ->capture_default_str();
  command->add_option("--duration", options.duration, "Length of the run [s]")
      ->check(number_within(1e-5, 1e7))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of road and sensor noise")
      ->check(whole_64_bit_number())
      ->capture_default_str();
  command
      ->add_option("--bandwidth", options.bandwidth,
                   "Low-pass frequency of an ISO 8608 road [Hz] (default: 100 for hil, else 30)")
      ->check(number_within(0.1, 2e4));
  command
      ->add_option("--cut-off", options.cut_off,
                   "Frequency below which the spectrum of an ISO 8608 road is flat [Hz] (default: 0.05)")
      ->check(number_within(0.001, 10.0));
  command->add_flag("--no-noise", options.no_noise, "Simulate the sensors without noise");
  command->add_flag("--allow-stop", options.allow_stop,
                    "Keep the recording of a run that the firmware stopped before its end, with exit status 0; without "
                    "it the status is 6 and nothing is written");
  command->add_option("--json", options.json, "Write the result as JSON (- for standard output)");
  command->add_option("--report", options.report, "Write the run as a page (HTML): traces, spectra, statistics");
  command->callback([&options] { simulate(options); });
}

}  // namespace host_sim
