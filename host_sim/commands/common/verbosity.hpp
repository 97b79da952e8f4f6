// --quiet and --verbose, the same for every command.
#pragma once

namespace CLI {
class App;
}

namespace host_sim {

/// The output of a command beside its results: errors always, progress and remarks normally on a terminal, with
/// --verbose progress as lines anywhere, with --quiet neither, and nothing on standard output but what "-" asks for.
enum class Verbosity { quiet, normal, verbose };

/// Of this process.
[[nodiscard]] Verbosity verbosity();

/// Adds --quiet and --verbose to every command of `app`. `argc`, `argv`: the command line; an output that is "-" stays
/// on standard output under --quiet.
void add_verbosity(CLI::App& app, int argc, const char* const* argv);

}  // namespace host_sim
