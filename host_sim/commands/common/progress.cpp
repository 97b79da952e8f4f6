#include "host_sim/commands/common/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "host_sim/commands/common/verbosity.hpp"

namespace host_sim {

namespace {
double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// ", 3 min left": the rest at the speed so far. Nothing in the first two seconds, in which the speed is a guess.
std::string time_left(double seconds, double done, double left) {
  if (seconds < 2.0 || !(done > 0.0)) return {};
  const double rest = seconds * left / done;
  char text[48];
  if (rest < 90.0) {
    std::snprintf(text, sizeof text, ", %.0f s left", std::ceil(rest));
  } else if (rest < 5400.0) {
    std::snprintf(text, sizeof text, ", %.0f min left", std::round(rest / 60.0));
  } else {
    std::snprintf(text, sizeof text, ", %.1f h left", rest / 3600.0);
  }
  return text;
}
}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1 && verbosity() != Verbosity::quiet) {}

Progress::~Progress() { end(); }

void Progress::end() {
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

void Progress::show(double share, const std::string& detail) {
  const double now = seconds_now();
  const bool next_tenth = std::floor(10.0 * share) > std::floor(10.0 * highest_);
  share = highest_ = std::max(highest_, share);
  if (verbosity() == Verbosity::verbose) {
    if (next_tenth) std::fprintf(stderr, "%s %3.0f %% %s\n", what_.c_str(), std::floor(100.0 * share), detail.c_str());
    return;
  }
  if (!terminal_) return;
  if (shown_ && now - last_ < 0.1) return;
  last_ = now;
  shown_ = true;
  if (!(first_share_ <= share)) {  // the work begins
    first_share_ = share;
    first_ = now;
  }
  std::fprintf(stderr, "\r\033[K%s %3.0f %%%s %s", what_.c_str(), std::floor(100.0 * share),
               time_left(now - first_, share - first_share_, 1.0 - share).c_str(), detail.c_str());
  std::fflush(stderr);
}

}  // namespace host_sim
