#include "host_sim/commands/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/run_stopped.hpp"
#include "firmware/description/text/spelling.hpp"
#include "firmware/description/version.hpp"
#include "host_sim/commands/channels_command.hpp"
#include "host_sim/commands/common/commit.hpp"
#include "host_sim/commands/common/emphasis.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/verbosity.hpp"
#include "host_sim/commands/compare_command.hpp"
#include "host_sim/commands/compensation_command.hpp"
#include "host_sim/commands/diagnose_command.hpp"
#include "host_sim/commands/effects_command.hpp"
#include "host_sim/commands/estimate_command.hpp"
#include "host_sim/commands/fmu_command.hpp"
#include "host_sim/commands/frf_command.hpp"
#include "host_sim/commands/import_command.hpp"
#include "host_sim/commands/init_command.hpp"
#include "host_sim/commands/new_effect_command.hpp"
#include "host_sim/commands/paper_command.hpp"
#include "host_sim/commands/plan_command.hpp"
#include "host_sim/commands/replicate_command.hpp"
#include "host_sim/commands/shell_command.hpp"
#include "host_sim/commands/show_command.hpp"
#include "host_sim/commands/simulate_command.hpp"
#include "host_sim/commands/stability_command.hpp"
#include "host_sim/commands/sweep_command.hpp"
#include "host_sim/commands/transfer_command.hpp"
#include "host_sim/commands/watch_command.hpp"

namespace host_sim {
namespace {

constexpr std::string_view unwritable_output = "standard output: cannot be written, expected room for the results";

int fail(firmware::ExitStatus status, std::string_view message) {
  std::fprintf(stderr, "%s %s\n", emphasised("rigtwin:", Emphasis::error, stderr).c_str(),
               firmware::one_line(message).c_str());
  return static_cast<int>(status);
}

/// Names the unknown command and the one that was probably meant, or lists the known ones. (CLI11 only says that a
/// subcommand is required.)
void demand_command(const CLI::App& app, const std::string& word) {
  if (word.starts_with('-')) return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  if (std::find(known.begin(), known.end(), word) != known.end()) return;
  throw firmware::UsageError(firmware::with_suggestion("unknown command", word, known) + ", expected one of " +
                             firmware::listed(known));
}

/// `rigtwin`, `rigtwin help` and `rigtwin help COMMAND`.
void print_help(const CLI::App& app, const std::string& command) {
  if (command.empty()) {
    std::fputs(app.help().c_str(), stdout);
  } else {
    demand_command(app, command);
    std::fputs(app.get_subcommand(command)->help(app.get_name()).c_str(), stdout);
  }
}

std::string version_text() {
  return "rigtwin " + std::string(firmware::version) + (commit.empty() ? "" : " (" + std::string(commit) + ")");
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  remember_command_line(argc, argv);
  CLI::App app("rigtwin: one model of a suspension rig, on the rig's controller and on the PC", "rigtwin");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  SimulateOptions simulate_options;
  CompareOptions compare_options;
  add_simulate(app, simulate_options);
  add_compare(app, compare_options);
  ShowOptions show_options;
  add_show(app, show_options);
  StabilityOptions stability_options;
  add_stability(app, stability_options);
  CompensationOptions compensation_options;
  add_compensation(app, compensation_options);
  FrfOptions frf_options;
  add_frf(app, frf_options);
  DiagnoseOptions diagnose_options;
  add_diagnose(app, diagnose_options);
  PlanOptions plan_options;
  add_plan(app, plan_options);
  SweepOptions sweep_options;
  add_sweep(app, sweep_options);
  ReplicateOptions replicate_options;
  add_replicate(app, replicate_options);
  ImportOptions import_options;
  add_import(app, import_options);
  FmuOptions fmu_options;
  add_fmu(app, fmu_options);
  ChannelsOptions channels_options;
  add_channels(app, channels_options);
  EffectsOptions effects_options;
  add_effects(app, effects_options);
  InitOptions init_options;
  add_init(app, init_options);
  NewEffectOptions new_effect_options;
  add_new_effect(app, new_effect_options);
  ShellOptions shell_options;
  add_shell(app, shell_options);
  PaperOptions paper_options;
  add_paper(app, paper_options);
  EstimateOptions estimate_options;
  add_estimate(app, estimate_options);
  TransferOptions transfer_options;
  add_transfer(app, transfer_options);
  WatchOptions watch_options;
  add_watch(app, watch_options);
  add_verbosity(app, argc, argv);
  try {
    if (argc < 2 || std::string_view(argv[1]) == "help") {
      print_help(app, argc > 2 ? argv[2] : "");
    } else {
      demand_command(app, argv[1]);
      app.parse(argc, argv);
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      return fail(firmware::ExitStatus::cannot_write, unwritable_output);
    }
    return static_cast<int>(firmware::ExitStatus::done);
  } catch (const CLI::Success& help) {
    app.exit(help);
    std::cout.flush();
    return std::cout ? static_cast<int>(firmware::ExitStatus::done)
                     : fail(firmware::ExitStatus::cannot_write, unwritable_output);
  } catch (const CLI::ParseError& error) {
    return fail(firmware::ExitStatus::wrong_usage, std::string(error.what()) + " (see rigtwin --help)");
  } catch (const firmware::UsageError& error) {
    return fail(firmware::ExitStatus::wrong_usage, error.what());
  } catch (const firmware::InputError& error) {
    return fail(firmware::ExitStatus::unfit_input, error.what());
  } catch (const firmware::RunStopped& stopped) {
    fail(firmware::ExitStatus::done, stopped.what());
    return firmware::exit_status_of_stopped_run;
  } catch (const firmware::OutputError& error) {
    return fail(firmware::ExitStatus::cannot_write, error.what());
  } catch (const std::bad_alloc&) {
    return fail(firmware::ExitStatus::internal, "out of memory");
  } catch (const std::exception& error) {
    return fail(firmware::ExitStatus::internal, std::string("internal error: ") + error.what());
  }
}

}  // namespace host_sim
