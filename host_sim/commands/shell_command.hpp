// rigtwin completion and rigtwin manpage: what a shell and man(1) know of the commands.
#pragma once

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

/// Adds both sub-commands. They describe `app` as it is when they run, so they know every command and option.
void add_shell(CLI::App& app);

}  // namespace host_sim
