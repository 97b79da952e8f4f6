// Random faults in a session of rig_controller: exit status and recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "firmware/controller/run.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/loop/common/trip.hpp"
#include "hal/simulated/fault_plan.hpp"

namespace faults {

/// How a session with the faults of a seed ended. `violated`: what does not hold of its status and its recording;
/// empty: everything.
struct SessionEnd {
  firmware::Reason reason = firmware::Reason::none;
  std::string violated;
};

constexpr const char* session_road = "iso8608:A";
constexpr double session_length = 1.5;  ///< of the run [s]

/// One session with these faults over session_road, recorded in `file`; `seed`: of road and noise.
[[nodiscard]] firmware::controller::Status record_session(const firmware::RigDescription& rig,
                                                          const hal::simulated::FaultPlan& plan, std::uint64_t seed,
                                                          const std::filesystem::path& file);

/// Runs the session of the program itself – loop, threads, recording – on the simulated rig in virtual time, and looks
/// at what it leaves. What it prints is dropped. `operated`: an operator who is drawn leads it through several armings,
/// with all their checks, and runs; else it arms and starts by itself.
[[nodiscard]] SessionEnd play_session(std::uint64_t seed, bool operated);

}  // namespace faults
