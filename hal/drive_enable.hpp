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

  /// True: a contact that moves with the power shows whether it is on (external device monitoring, ISO 13849).
  [[nodiscard]] virtual bool feedback_fitted() const { return false; }
  /// What that contact shows: the drive has power. Any fault: nobody knows. Only where it is fitted.
  [[nodiscard]] Result<bool> feedback() { return do_feedback(); }

 private:
  virtual Result<void> do_write(bool on) = 0;
  virtual Result<bool> do_feedback() { return Fault::refused; }
};

/// For a rig without an enable output.
class NoEnable final : public DriveEnable {
 public:
  [[nodiscard]] bool fitted() const override { return false; }

 private:
  Result<void> do_write(bool) override { return {}; }
};

}  // namespace hal
