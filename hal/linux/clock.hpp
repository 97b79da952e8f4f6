// The machine's own clock.
#pragma once

#include "hal/clock.hpp"

namespace hal::linux {

/// CLOCK_MONOTONIC, which GPIO edges and converter samples are stamped with too. Sleeps until an absolute time: what a
/// period took does not shift the next; a signal does not end a sleep.
class MonotonicClock final : public Clock {
 private:
  Time do_now() override;
  Time do_suspended() override;  ///< CLOCK_BOOTTIME less CLOCK_MONOTONIC
  void do_sleep_until(Time deadline) override;
};

}  // namespace hal::linux
