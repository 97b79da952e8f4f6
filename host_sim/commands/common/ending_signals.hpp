// Signals that end a program which goes on until somebody ends it.
#pragma once

#include <signal.h>

namespace host_sim {

/// Blocks INT, TERM and HUP in this thread and in those that it makes; sigwait() and sigtimedwait() take them.
[[nodiscard]] sigset_t block_ending_signals();

}  // namespace host_sim
