// What the drive of the rig is told.
#pragma once

#include <cmath>

#include "hal/result.hpp"

namespace hal {

/// Where the drive shall be one period from now. Velocity and acceleration are feed-forward for drives that take them.
struct Command {
  double position = 0.0;      ///< [m]
  double velocity = 0.0;      ///< [m/s]
  double acceleration = 0.0;  ///< [m/s²]

  friend constexpr bool operator==(const Command&, const Command&) = default;
};

/// The set point of the drive: the foot point's cylinder, or the machine that deflects a component.
///
/// Returns within the control period. timeout: the drive keeps its last set point; write again in the next period.
/// disconnected, refused: what the drive does is unknown; make the rig safe.
/// A command that is not finite never reaches a back-end: refused.
class CommandOutput {
 public:
  virtual ~CommandOutput() = default;

  [[nodiscard]] Result<void> write(const Command& command) {
    if (!std::isfinite(command.position) || !std::isfinite(command.velocity) || !std::isfinite(command.acceleration)) {
      return Fault::refused;
    }
    return do_write(command);
  }

  /// The position that the output shows now [m], rounded as its converter rounds. refused: this output cannot tell.
  [[nodiscard]] Result<double> read_back() { return do_read_back(); }

 private:
  virtual Result<double> do_read_back() { return Fault::refused; }
  virtual Result<void> do_write(const Command& command) = 0;
};

}  // namespace hal
