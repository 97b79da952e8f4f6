#include "host_sim/commands/common/verbosity.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string_view>

#include "firmware/description/text/input_error.hpp"

namespace host_sim {
namespace {

Verbosity chosen = Verbosity::normal;

}  // namespace

Verbosity verbosity() { return chosen; }

void add_verbosity(CLI::App& app, int argc, const char* const* argv) {
  bool printed = false;  // a result that "-" asks for
  for (int i = 1; i < argc; ++i) {
    for (const std::string_view option : {"--out", "--json"}) {
      const std::string_view word(argv[i]);
      const bool next = word == option && i + 1 < argc && std::string_view(argv[i + 1]) == "-";
      printed = printed || next || (word.starts_with(option) && word.substr(option.size()) == "=-");
    }
  }
  const auto choose = [](Verbosity wanted) {
    if (chosen != Verbosity::normal) throw firmware::UsageError("--quiet and --verbose: expected one of them");
    chosen = wanted;
  };
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    command->add_flag_callback(
        "--quiet",
        [printed, choose] {
          choose(Verbosity::quiet);
          if (!printed) static_cast<void>(std::freopen("/dev/null", "w", stdout));
        },
        "Print errors only; results go to their files");
    command->add_flag_callback(
        "--verbose", [choose] { choose(Verbosity::verbose); },
        "Show progress as lines on standard error, also where that is no terminal");
  }
}

}  // namespace host_sim
