#include "host_sim/commands/verbosity.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string_view>

#include "firmware/description/text/input_error.hpp"

namespace host_sim {
namespace {

Verbosity chosen = Verbosity::normal;

}  // namespace

Verbosity verbosity() { return chosen; }

void add_verbosity(CLI::App& app, int argc, const char* const* argv) {
  const bool printed = std::any_of(argv, argv + argc, [](const char* word) {
    const std::string_view text(word);
    return text == "-" || (text.starts_with("--") && text.ends_with("=-"));
  });
  const auto choose = [](Verbosity wanted) {
    if (chosen != Verbosity::normal) throw firmware::UsageError("--quiet and --verbose: expected one of them");
    chosen = wanted;
  };
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    command->add_flag_callback(
        "--quiet",
        [printed, choose] {
          choose(Verbosity::quiet);
          // Where "-" asks for a result there, the command prints nothing else.
          if (!printed && std::freopen("/dev/null", "w", stdout) == nullptr) std::fclose(stdout);
        },
        "Print errors only; results go to their files");
    command->add_flag_callback(
        "--verbose", [choose] { choose(Verbosity::verbose); },
        "Show progress as lines on standard error, also where that is no terminal");
  }
}

}  // namespace host_sim
