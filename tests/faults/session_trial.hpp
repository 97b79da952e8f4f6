// Random faults in a session of rig_controller: exit status and recording.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/loop/trip.hpp"

namespace faults {

/// How a session with the faults of a seed ended. `violated`: what does not hold of its status and its recording;
/// empty: everything.
struct SessionEnd {
  firmware::Reason reason = firmware::Reason::none;
  std::string violated;
};

/// Runs the session of the program itself – loop, threads, recording – on the simulated rig in virtual time, and looks
/// at what it leaves. What it prints is dropped.
[[nodiscard]] SessionEnd play_session(std::uint64_t seed);

}  // namespace faults
