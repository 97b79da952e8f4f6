// The set point of an air spring's area.
#pragma once

#include <cmath>

#include "hal/result.hpp"

namespace hal {

/// The actuator that changes the effective area of an active air spring.
///
/// Returns within the control period. Any fault: the actuator keeps its last set point, or nobody knows; make the rig
/// safe. A command that is not finite never reaches a back-end: refused.
class AreaOutput {
 public:
  virtual ~AreaOutput() = default;

  /// The relative change of the area for the period that begins.
  [[nodiscard]] Result<void> write(double area) {
    if (!std::isfinite(area)) return Fault::refused;
    return do_write(area);
  }

 private:
  virtual Result<void> do_write(double area) = 0;
};

}  // namespace hal
