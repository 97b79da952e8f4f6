// A broken assumption of ours stops the program, in every build.
#pragma once

#include <cstdlib>

namespace model {

/// The last assumption that did not hold, for a debugger or a trap handler to read.
inline const char* volatile broken_assumption = nullptr;

[[noreturn]] inline void stop(const char* assumption) {
  broken_assumption = assumption;
  std::abort();
}

constexpr void require(bool holds, const char* assumption) {
  if (!holds) stop(assumption);
}

}  // namespace model
