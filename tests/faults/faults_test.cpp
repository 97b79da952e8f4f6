// The first hundred scenarios of the fault campaign; rigtwin_faults plays as many as wanted.
#include <gtest/gtest.h>

#include "tests/faults/campaign.hpp"
#include "tests/faults/session_trial.hpp"

namespace {

// Law. Whatever goes wrong in whatever state: the drive stays within stroke and braking distance, never jumps, stands
// without power and after a press, comes to rest in its time; power comes only where somebody has asked for it; a force
// beyond its limit does not grow; faults that must trip do; valves are safe in safe; every period and the first reason
// are on record.
TEST(Faults, AHundredScenariosKeepTheInvariants) {
  int runs = 0, faults = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    faults::Trial trial(seed);
    EXPECT_EQ(trial.play(), "") << "seed " << seed;
    runs += trial.has_run() ? 1 : 0;
    faults += is_fault(trial.reason()) ? 1 : 0;
  }
  EXPECT_GE(runs, 30) << "many scenarios come to a run";
  EXPECT_GE(faults, 30) << "and many end by a fault";
}

// Law. The program's own session leaves a recording with every period up to its end, the reason of its last row in its
// last line, and a status that says whether that was a fault; half of them with an operator, several armings and runs.
TEST(Faults, TenSessionsLeaveTheirReasonAndStatus) {
  int faults = 0;
  for (std::uint64_t seed = 10; seed <= 100; seed += 10) {
    const faults::SessionEnd end = faults::play_session(seed, seed % 20 == 0);
    EXPECT_EQ(end.violated, "") << "seed " << seed;
    faults += is_fault(end.reason) ? 1 : 0;
  }
  EXPECT_GE(faults, 3);
}

// Fault. Operated sessions of a hil rig without any fault, which the energy guard ended: the force had been faded in, and
// what the component had taken before the guard began was given back.
TEST(Faults, ASessionWithoutAFaultEndsWithoutOne) {
  for (const std::uint64_t seed : {141U, 273U}) EXPECT_EQ(faults::play_session(seed, true).violated, "") << seed;
}

}  // namespace
