// The command line of the program rigtwin.
#pragma once

namespace host_sim {

/// Runs one command and returns its exit status: 0 done, 2 wrong usage, 3 unreadable or unfit input, 4 cannot write,
/// 5 internal error, 6 the firmware stopped a simulated run. Every error is one line on standard error.
[[nodiscard]] int run_command_line(int argc, const char* const* argv);

}  // namespace host_sim
