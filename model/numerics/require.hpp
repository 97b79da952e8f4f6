// Stops the program, in every build, when an assumption of our own does not hold.
#pragma once

#include <cstdlib>

namespace model {

/// The assumption that did not hold, for a debugger or a trap handler.
inline const char* volatile broken_assumption = nullptr;

[[noreturn]] inline void stop(const char* assumption) {
  broken_assumption = assumption;
  std::abort();
}

constexpr void require(bool holds, const char* assumption) {
  if (!holds) stop(assumption);
}

}  // namespace model
