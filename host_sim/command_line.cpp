#include "host_sim/command_line.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>

#include "host_sim/diagnose_command.hpp"
#include "host_sim/frf_command.hpp"
#include "host_sim/input_error.hpp"
#include "host_sim/paper_command.hpp"
#include "host_sim/recording_columns.hpp"
#include "host_sim/stability_command.hpp"
#include "host_sim/version.hpp"

namespace host_sim {
namespace {

constexpr std::string_view unwritable_output = "standard output: cannot be written, expected room for the results";

/// Numbers within bounds. (CLI::Range lets NaN pass: it compares false.)
CLI::Validator within(double lowest, double highest) {
  const auto check = [lowest, highest](const std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value >= lowest && value <= highest) return std::string();
    return "is " + in_quotes(text) + ", expected a number from " + shortest(lowest) + " to " + shortest(highest);
  };
  return CLI::Validator(check, "");
}

/// (CLI11 reads −1 as 2⁶⁴ − 1, and what is larger as the same.)
CLI::Validator a_seed() {
  const auto check = [](const std::string& text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec == std::errc() && read.ptr == end) return std::string();
    return "is " + in_quotes(text) + ", expected a whole number from 0 to 18446744073709551615";
  };
  return CLI::Validator(check, "");
}

StartChoice start_choice(const std::string& word) {
  if (word == "automatic") return StartChoice::automatic;
  if (word == "rest") return StartChoice::rest;
  if (word == "estimated") return StartChoice::estimated;
  throw UsageError("--start: is " + in_quotes(word) + ", expected automatic, rest or estimated");
}

int fail(ExitStatus status, std::string_view message) {
  std::fprintf(stderr, "rigtwin: %s\n", one_line(message).c_str());
  return static_cast<int>(status);
}

void add_simulate(CLI::App& app, SimulateOptions& options) {
  CLI::App* command = app.add_subcommand("simulate", "Drive a simulated rig over a road, through the firmware");
  command->add_option("--rig", options.rig, "Rig description (TOML)")->required();
  command->add_option("--out", options.out, "Recording to write: CSV, or MATLAB if the name ends in .mat")->required();
  command->add_option("--road", options.road, "iso8608:A … iso8608:H, or a file with t [s] or s [m], and z_r [m]")
      ->capture_default_str();
  command->add_option("--speed", options.speed, "Speed over the road [m/s]")
      ->check(within(0.1, 150.0))
      ->capture_default_str();
  command->add_option("--duration", options.duration, "Length of the run [s]")
      ->check(within(1e-5, 1e7))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of road and sensor noise")->check(a_seed())->capture_default_str();
  command
      ->add_option("--bandwidth", options.bandwidth,
                   "Low-pass of an ISO 8608 road [Hz] (default: 100 for hil, else 30)")
      ->check(within(0.1, 2e4));
  command
      ->add_option("--cut-off", options.cut_off,
                   "Below it the spectrum of an ISO 8608 road is flat [Hz] (default: 0.05)")
      ->check(within(0.001, 10.0));
  command->add_flag("--no-noise", options.no_noise, "Sensors without the noise of the rig description");
  command->callback([&options] { simulate(options); });
}

void add_compare(CLI::App& app, CompareOptions& options) {
  CLI::App* command = app.add_subcommand("compare", "Hold recordings against the simulation of their own input");
  command->add_option("--rig", options.rig, "Rig description (TOML)")->required();
  command->add_option("--data", options.data, "Recording (CSV or .mat); may be given several times")->required();
  command->add_option("--json", options.json, "Write the result as JSON (- for standard output)");
  command->add_flag("--refit", options.refit, "First fit the parameters under [tolerance], inside their bounds");
  command->add_option_function<std::string>(
      "--start", [&options](const std::string& word) { options.start = start_choice(word); },
      "State at the start of a recording: rest, estimated, or automatic (rest where it begins quietly)");
  command->callback([&options] { compare(options); });
}

/// (CLI11 would only say that a subcommand is required.)
void demand_command(const CLI::App& app, const std::string& word) {
  std::string known;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (word == command->get_name()) return;
    known += (known.empty() ? "" : ", ") + command->get_name();
  }
  if (!word.starts_with('-')) throw UsageError("unknown command " + in_quotes(word) + ", expected one of " + known);
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  CLI::App app("rigtwin: one model of a suspension rig, on the rig's controller and on the PC", "rigtwin");
  app.set_version_flag("--version", "rigtwin " + std::string(version));
  app.require_subcommand(1);
  SimulateOptions simulate_options;
  CompareOptions compare_options;
  add_simulate(app, simulate_options);
  add_compare(app, compare_options);
  StabilityOptions stability_options;
  add_stability(app, stability_options);
  FrfOptions frf_options;
  add_frf(app, frf_options);
  DiagnoseOptions diagnose_options;
  add_diagnose(app, diagnose_options);
  PaperOptions paper_options;
  add_paper(app, paper_options);
  try {
    if (argc > 1) demand_command(app, argv[1]);
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      return fail(ExitStatus::cannot_write, unwritable_output);
    }
    return static_cast<int>(ExitStatus::done);
  } catch (const CLI::Success& help) {
    app.exit(help);
    std::cout.flush();
    return std::cout ? static_cast<int>(ExitStatus::done) : fail(ExitStatus::cannot_write, unwritable_output);
  } catch (const CLI::ParseError& error) {
    return fail(ExitStatus::wrong_usage, std::string(error.what()) + " (rigtwin --help tells more)");
  } catch (const UsageError& error) {
    return fail(ExitStatus::wrong_usage, error.what());
  } catch (const InputError& error) {
    return fail(ExitStatus::unfit_input, error.what());
  } catch (const OutputError& error) {
    return fail(ExitStatus::cannot_write, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitStatus::internal, "out of memory");
  } catch (const std::exception& error) {
    return fail(ExitStatus::internal, std::string("internal error: ") + error.what());
  }
}

}  // namespace host_sim
