// rigtwin completion and rigtwin manpage: what a shell and man(1) know of the commands.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct ShellOptions {
  std::string shell = "bash";
  std::string json;  ///< all commands and options as JSON in place of the text; "-": standard output
};

/// Adds both sub-commands. They describe `app` as it is when they run, so they know every command and option. `options`
/// must live as long as `app`.
void add_shell(CLI::App& app, ShellOptions& options);

}  // namespace host_sim
