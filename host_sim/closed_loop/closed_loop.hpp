// The closed loop in virtual time: road → plant → sensors → hal → firmware → hal → valves and command → plant.
#pragma once

#include <cstdint>
#include <functional>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/control_loop.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/road.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "hal/simulated/fault_plan.hpp"

namespace host_sim {

/// Result of a simulated run.
struct Run {
  firmware::Recording
      recording;        ///< one row a period of mode running; extra columns: soft sensor, estimated velocities
  firmware::Trip trip;  ///< reason of its end: Reason::reference_ended at the end of the road
  firmware::Counters counters;
  std::size_t lost_records = 0;  ///< records that the journal lost
};

/// Options of a run that are not part of the rig description.
struct RunOptions {
  std::uint64_t seed = 1;  ///< of the sensor noise
  firmware::SimulatedRig::Noise noise = firmware::SimulatedRig::Noise::as_described;
  hal::simulated::FaultPlan faults{};
  std::function<void(double)> progress{};  ///< called repeatedly with the share of the run that is done, 0 … 1
};

/// Drives the rig over `excitation` (one motion a period: foot point, or deflection of a component_bench) through the
/// firmware, in virtual time, until the excitation ends or the firmware trips. InputError if the sample period is not a
/// whole number of nanoseconds. A driven_mass has no controller: the excitation is its force.
[[nodiscard]] Run run_closed_loop(const firmware::RigDescription& description,
                                  const firmware::FootPointMotion& excitation, const RunOptions& options);

}  // namespace host_sim
