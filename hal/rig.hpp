// All roles of a rig, in one hand.
#pragma once

#include "hal/area_output.hpp"
#include "hal/clock.hpp"
#include "hal/command_output.hpp"
#include "hal/drive_enable.hpp"
#include "hal/heartbeat.hpp"
#include "hal/interlocks.hpp"
#include "hal/sensor_source.hpp"
#include "hal/stop_button.hpp"
#include "hal/valve_bank.hpp"

namespace hal {

/// The roles that a control program meets; who plays them is chosen where the program is put together.
struct Rig {
  Clock& clock;
  SensorSource& sensors;
  ValveBank& valves;
  CommandOutput& command;
  StopButton& stop_button;
  Heartbeat& heartbeat;
  DriveEnable& drive_enable;
  Interlocks& interlocks;
  AreaOutput* area = nullptr;            ///< of an active air spring, where there is one
  DriveEnable* high_pressure = nullptr;  ///< second stage of the power unit, where there is one
};

}  // namespace hal
