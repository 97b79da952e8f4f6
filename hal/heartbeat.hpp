// The sign of life to the rig's watchdog.
#pragma once

#include "hal/result.hpp"

namespace hal {

/// The sign of life for a watchdog outside the program, which makes the valves safe when the beats cease.
///
/// Beaten once a period by whoever is in charge of the valves; whoever has lost them stops beating.
/// Any fault: the watchdog is about to act, or is not there; make the rig safe.
class Heartbeat {
 public:
  virtual ~Heartbeat() = default;

  [[nodiscard]] Result<void> beat() { return do_beat(); }

 private:
  virtual Result<void> do_beat() = 0;
};

}  // namespace hal
