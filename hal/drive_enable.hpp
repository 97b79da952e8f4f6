// Power to the drive.
#pragma once

#include "hal/result.hpp"

namespace hal {

/// The output that lets the drive move: the valve that holds the cylinder's pressure, or a converter's enable input.
///
/// Off is what the line shows without power and without a program. Written at every change, and again after a fault.
/// Any fault: whether the drive has power is unknown; stop the heartbeat, so that the watchdog takes the power away.
class DriveEnable {
 public:
  virtual ~DriveEnable() = default;

  [[nodiscard]] Result<void> write(bool on) { return do_write(on); }

  /// False: the rig has no such output, and the drive has power at all times.
  [[nodiscard]] virtual bool fitted() const { return true; }

 private:
  virtual Result<void> do_write(bool on) = 0;
};

/// For a rig without an enable output.
class NoEnable final : public DriveEnable {
 public:
  [[nodiscard]] bool fitted() const override { return false; }

 private:
  Result<void> do_write(bool) override { return {}; }
};

}  // namespace hal
