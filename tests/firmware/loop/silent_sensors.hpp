// Sensors that are fitted and never answer: what a guard sees is handed to it.
#pragma once

#include "hal/sensor_source.hpp"

namespace rig_under_test {

class SilentSensors final : public hal::SensorSource {
 public:
  explicit SilentSensors(const hal::SensorSetup& setup) : SensorSource(setup) {}

 private:
  hal::Result<hal::Frame> do_read() override { return hal::Fault::timeout; }
};

}  // namespace rig_under_test
