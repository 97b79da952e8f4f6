// The only one who knows what time it is.
#pragma once

#include "hal/time.hpp"

namespace hal {

/// The time of the rig: a monotonic clock of the machine, virtual time in simulation, the rows of a recording in
/// replay.
///
/// Every stamp that a back-end gives is on this clock. now() never runs backwards.
class Clock {
 public:
  virtual ~Clock() = default;

  [[nodiscard]] Time now() { return do_now(); }

  /// Returns at the deadline or later, at once when it has passed; whoever wakes late sees it from now().
  void sleep_until(Time deadline) { do_sleep_until(deadline); }

  /// How long the machine has been suspended since it started, which now() does not count.
  [[nodiscard]] Time suspended() { return do_suspended(); }

 private:
  virtual Time do_now() = 0;
  virtual Time do_suspended() { return {}; }
  virtual void do_sleep_until(Time deadline) = 0;
};

}  // namespace hal
