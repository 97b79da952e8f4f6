#include "hal/linux/clock.hpp"

#include <cerrno>
#include <ctime>

namespace hal::linux {

namespace {

Time read(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return nanoseconds(static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec);
}

}  // namespace

Time MonotonicClock::do_now() { return read(CLOCK_MONOTONIC); }

/// Read in this order: what passes between the two readings is never counted as sleep twice, and a thread that is kept
/// from running between them for longer than a gap has one.
Time MonotonicClock::do_suspended() {
  const Time monotonic = read(CLOCK_MONOTONIC);
  return read(CLOCK_BOOTTIME) - monotonic;
}

void MonotonicClock::do_sleep_until(Time deadline) {
  if (deadline.ns < 0) return;
  timespec until{};
  until.tv_sec = static_cast<time_t>(deadline.ns / 1'000'000'000);
  until.tv_nsec = static_cast<long>(deadline.ns % 1'000'000'000);
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace hal::linux
