// Stops the program when one of its own assumptions is broken.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace hal {

/// A broken assumption is ours, not the world's: it stops the program in every build, and the rig's own watchdog makes
/// the valves safe. (hal sees no other room, hence its own.)
constexpr void require(bool holds, const char* assumption) {
  if (holds) return;
  std::fputs("hal: broken assumption: ", stderr);
  std::fputs(assumption, stderr);
  std::fputs("\n", stderr);
  std::abort();
}

}  // namespace hal
