#include "host_sim/commands/compensation_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/compensation/comparison_report.hpp"
#include "host_sim/compensation/machine_record.hpp"
#include "host_sim/compensation/record_page.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/report/formatted.hpp"

namespace host_sim {
namespace {

std::string error_text(const std::optional<double>& value) {
  return value ? formatted("%.3g %%", 100.0 * *value) : "unstable";
}

void print_comparison(const std::string& rig, const compensation::MethodComparison& comparison) {
  std::printf("%s: machine %.4g ms late; undelayed wheel-load peak %.5g N/m at %.4g Hz\n", rig.c_str(),
              1e3 * comparison.delay, comparison.peak, comparison.peak_hz);
  std::printf("  %-25s %11s", "", "tracking");
  for (const char* name : compensation::change_names) std::printf(" %22s", name);
  std::printf(" %10s %s\n", "margin", "component model");
  for (const auto& method : comparison.methods) {
    std::printf("  %-25s %11s", method.name.c_str(), error_text(method.over_changes[0].tracking).c_str());
    for (const auto& loop : method.over_changes) std::printf(" %22s", error_text(loop.peak_error).c_str());
    if (method.critical_error) {
      std::printf(" %7.3g ms", 1e3 * *method.critical_error);
    } else {
      std::printf(" %10s", "none");
    }
    std::printf(" %s\n", method.needs_component_model ? "needed" : "-");
  }
  std::printf(
      "tracking: rms of x_act - x over a road; then the error of the wheel-load peak, for changes that the method "
      "does\n"
      "not know of; margin: the smallest error of the assumed delay that is unstable\n");
}

void print_record(const std::string& data, const compensation::MachineRecord& record) {
  std::printf("%s: command from %.3g to %.3g Hz; machine with delay %.4g ms, lag %.4g ms", data.c_str(),
              record.lowest_hz, record.highest_hz, 1e3 * record.machine.delay, 1e3 * record.machine.lag);
  if (record.machine.resonance_frequency > 0.0) {
    std::printf(", resonance %.4g Hz with %.3g damping", record.machine.resonance_frequency,
                record.machine.resonance_damping);
  }
  std::printf("\nrms(x_act - x_cmd) / rms(x_cmd), and as predicted with the command led by\n  %-28s %8.3g %%\n",
              "nothing, as recorded", 100.0 * record.uncompensated);
  for (const auto& method : record.methods) {
    const bool delay = method.name == compensation::best_pure_delay;
    const std::string label =
        method.name + (delay ? " of " + std::to_string(1e3 * record.pure_delay).substr(0, 5) + " ms" : "");
    std::printf("  %-28s %8.3g %%\n", label.c_str(), 100.0 * method.error);
  }
}

/// A recording of the machine: no loop is needed, so a component_bench will do.
void examine_record(const CompensationOptions& options, const firmware::RigDescription& description) {
  if (options.out) refuse_unknown_ending(*options.out);
  const firmware::Recording recording = read_recording(*options.data, description.channels);
  const auto record = compensation::machine_record(description, recording);
  if (options.out) write_recording(*options.out, compensation::compensated_command(record, recording));
  if (options.report) {
    firmware::write_file(*options.report, with_how_made(compensation::record_page(record, recording)));
  }
  if (write_json(options.json, compensation::to_json(record))) return;
  print_record(*options.data, record);
  if (options.out) std::printf("command %s\n", options.out->c_str());
  if (options.report) std::printf("report %s\n", options.report->c_str());
}

void compare_compensation(const CompensationOptions& options) {
  if (options.out && !options.data) throw firmware::UsageError("--out needs the recording of a machine, --data");
  if (options.out && options.json == options.out) {
    throw firmware::UsageError("--json and --out name the same file, expected two files");
  }
  if (options.report && options.json == options.report) {
    throw firmware::UsageError("--json and --report name the same file, expected two files");
  }
  const firmware::RigDescription description = firmware::read_rig(options.rig);
  if (options.data) {
    examine_record(options, description);
    return;
  }
  const auto comparison = compensation::compare_methods(description);
  if (options.report) {
    firmware::write_file(*options.report, with_how_made(compensation::comparison_page(comparison, description)));
  }
  if (write_json(options.json, compensation::to_json(comparison))) return;
  print_comparison(options.rig, comparison);
  if (options.report) std::printf("report %s\n", options.report->c_str());
}

}  // namespace

void add_compensation(CLI::App& app, CompensationOptions& options) {
  CLI::App* command =
      app.add_subcommand("compensation", "Delay compensation of a hil rig: every method, its errors and its margin");
  command
      ->add_option("--rig", options.rig,
                   "Rig description (TOML), kind = \"hil\"; with --data of any rig with a machine")
      ->required();
  command->add_option("--json", options.json, "Write the result as JSON (- for standard output)");
  command->add_option(
      "--data", options.data,
      "Recording of the machine, x_cmd and x_act: how well each compensation would have made x_act follow x_cmd");
  command->add_option("--out", options.out, "With --data: write the command that would have made x_act follow x_cmd");
  command->add_option("--report", options.report, "Write the result as one HTML page with figures");
  command->callback([&options] { compare_compensation(options); });
}

}  // namespace host_sim
