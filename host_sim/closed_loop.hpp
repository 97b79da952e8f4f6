// The loop closes here: road → plant → sensors → hal → firmware → hal → valves and command → plant.
#pragma once

#include <cstdint>
#include <functional>

#include "firmware/control_loop.hpp"
#include "hal/simulated/fault_plan.hpp"
#include "host_sim/recording.hpp"
#include "host_sim/rig_description.hpp"
#include "host_sim/road.hpp"
#include "host_sim/simulated_rig.hpp"

namespace host_sim {

/// What a simulated run left behind.
struct Run {
  Recording recording;  ///< one row a period of mode running; extra columns: soft sensor, estimated velocities
  firmware::Trip trip;  ///< why it ended: Reason::reference_ended when the road was over
  firmware::Counters counters;
  std::size_t lost_records = 0;  ///< by the journal
};

/// How a run is made beside the rig description.
struct RunOptions {
  std::uint64_t seed = 1;  ///< of the sensor noise
  SimulatedRig::Noise noise = SimulatedRig::Noise::as_described;
  hal::simulated::FaultPlan faults{};
  std::function<void(double)> progress{};  ///< called now and then with the share of the run that is done, 0 … 1
};

/// The channels that a simulated rig has sensors for: what the paper's rigs measure.
[[nodiscard]] hal::SensorSetup simulated_sensors(const RigDescription& description);

/// What the description says to the firmware.
[[nodiscard]] firmware::Settings firmware_settings(const RigDescription& description);
[[nodiscard]] firmware::ValvePlan valve_plan(const RigDescription& description);

/// Drives the rig over `excitation` (one motion a period: foot point, or deflection of a component_bench) through the
/// firmware, in virtual time, until the excitation is over or the firmware trips. A sample rate whose period is no
/// whole number of nanoseconds is an InputError.
[[nodiscard]] Run run_closed_loop(const RigDescription& description, const FootPointMotion& excitation,
                                  const RunOptions& options);

}  // namespace host_sim
