#include "host_sim/commands/progress.hpp"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

namespace host_sim {

namespace {
double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
}  // namespace

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(double share, const std::string& detail) {
  if (!terminal_) return;
  const double now = seconds_now();
  if (shown_ && now - last_ < 0.1) return;
  last_ = now;
  shown_ = true;
  std::fprintf(stderr, "\r\033[K%s %3.0f %% %s", what_.c_str(), std::floor(100.0 * share), detail.c_str());
  std::fflush(stderr);
}

}  // namespace host_sim
