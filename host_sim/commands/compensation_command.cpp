#include "host_sim/commands/compensation_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/how_made.hpp"
#include "host_sim/compensation/comparison_report.hpp"

namespace host_sim {
namespace {

std::string error_text(const std::optional<double>& value) {
  if (!value) return "unstable";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100.0 * *value);
  return text;
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

void compare_compensation(const CompensationOptions& options) {
  if (options.report && options.json == options.report) {
    throw firmware::UsageError("--json and --report name the same file, expected two files");
  }
  const firmware::RigDescription description = firmware::read_rig(options.rig);
  const auto comparison = compensation::compare_methods(description);
  if (options.report) {
    firmware::write_file(*options.report, with_how_made(compensation::comparison_page(comparison, description)));
  }
  if (options.json) {
    const std::string bytes =
        compensation::to_json(comparison).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (*options.json == "-") {
      std::fwrite(bytes.data(), 1, bytes.size(), stdout);
      return;
    }
    firmware::write_file(*options.json, bytes);
  }
  print_comparison(options.rig, comparison);
  if (options.report) std::printf("report %s\n", options.report->c_str());
}

}  // namespace

void add_compensation(CLI::App& app, CompensationOptions& options) {
  CLI::App* command =
      app.add_subcommand("compensation", "Delay compensation of a hil rig: every method, its errors and its margin");
  command->add_option("--rig", options.rig, "Rig description (TOML), kind = \"hil\"")->required();
  command->add_option("--json", options.json, "Write the result as JSON (- for standard output)");
  command->add_option("--report", options.report, "Write the result as one HTML page with figures");
  command->callback([&options] { compare_compensation(options); });
}

}  // namespace host_sim
