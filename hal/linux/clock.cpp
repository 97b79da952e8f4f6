#include "hal/linux/clock.hpp"

#include <cerrno>
#include <ctime>

namespace hal::linux {

Time MonotonicClock::do_now() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return nanoseconds(static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec);
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
