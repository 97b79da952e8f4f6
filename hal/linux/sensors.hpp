// The sensors of a rig: converters and lasers as one source.
#pragma once

#include <memory>
#include <vector>

#include "hal/clock.hpp"
#include "hal/sensor_source.hpp"

namespace hal::linux {

/// A device that fills some channels of a frame. It keeps its last samples: nothing new is the old value with its old
/// stamp.
class SensorPart {
 public:
  SensorPart() = default;
  SensorPart(const SensorPart&) = delete;
  SensorPart& operator=(const SensorPart&) = delete;
  virtual ~SensorPart() = default;

  /// Without waiting, without heap. `now`: when this period began.
  [[nodiscard]] virtual Result<void> read(Frame& frame, Time now) = 0;
};

/// Reads its parts in turn; a fault of one is the fault of all.
class Sensors final : public SensorSource {
 public:
  Sensors(const SensorSetup& setup, Clock& clock, std::vector<std::unique_ptr<SensorPart>> parts)
      : SensorSource(setup), clock_(clock), parts_(std::move(parts)) {}

 private:
  Result<Frame> do_read() override {
    Frame frame;
    const Time now = clock_.now();
    for (const auto& part : parts_) {
      const Result<void> read = part->read(frame, now);
      if (!read) return read.fault();
    }
    return frame;
  }

  Clock& clock_;
  std::vector<std::unique_ptr<SensorPart>> parts_;
};

}  // namespace hal::linux
