// The stop button, the drive's enable and the interlocks, in every state.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <tuple>

#include "tests/firmware/loop/rig_under_test.hpp"

namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using hal::Fault;
using hal::simulated::ChannelFault;
using hal::simulated::DeviceFault;
using hal::simulated::OpenInterlock;
using hal::simulated::Press;
using Device = DeviceFault::Device;
using model::RigKind;

/// A bench whose reference begins 30 mm from rest: 900 periods of ready, 1000 of running, 600 or so of the way back.
Scene bench() {
  Scene scene(RigKind::component_bench, 1000);
  scene.reference = road(1000, 1.0, 0.03);
  return scene;
}

/// Idle, armed from period 5, started at 10, run to its end.
void lead(Journey& run, int periods) {
  for (int k = 0; k < periods; ++k) {
    if (k == 5) run.loop.arm();
    if (k == 10) run.loop.start();
    run.periods(1);
  }
}

/// Somewhere in a state, with the command moving where the state moves it.
struct Moment {
  const char* name;
  Mode mode;
  int period;    ///< of the press
  int hold = 0;  ///< asked for in this period; 0: never
};

void PrintTo(const Moment& moment, std::ostream* out) { *out << moment.name; }

class StopInState : public testing::TestWithParam<Moment> {
 protected:
  /// The bench with the checks of arming: 1.2 s of them, the probe from 0.11 to 1.11 s, then start at 1.3 s.
  static Scene checked_bench() {
    Scene scene = bench();
    scene.settings.arming = {
        .tare_time = 0.1, .preload = 2500.0, .position_tolerance = 5e-3, .probe_amplitude = 2e-3, .force_ramp = 0.0};
    return scene;
  }
  static void lead_until(Journey& run, const Moment& moment) {
    for (int k = 0; k < moment.period; ++k) {
      if (k == 5) run.loop.arm();
      if (k == 1300) run.loop.start();
      if (k == moment.hold && k > 0) run.loop.hold();
      run.periods(1);
    }
  }
};

// Fault. Pressed in any state: no power from that very period on, the command stops within the braking distance and
// stays there, valves safe, and the record says so. At 20 m/s² 0.05 m/s stop within 63 µm and 3 periods.
TEST_P(StopInState, BrakesHoldsAndTakesThePower) {
  const Moment& moment = GetParam();
  const Press press{{ms * moment.period, ms * (moment.period + 1)}};
  Scene scene = checked_bench();
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  lead_until(run, moment);
  ASSERT_EQ(run.loop.mode(), moment.mode) << name(run.loop.mode());
  const double before = run.rig.command().position, velocity = run.records.back().command.velocity;
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_EQ(run.rig.openings(), scene.safe_position);
  EXPECT_FALSE(run.records.back().enabled);
  run.loop.arm();  // nothing that is asked for now starts anything
  run.loop.start();
  run.loop.resume();
  run.periods(1500);
  const double way = velocity * velocity / (2.0 * scene.settings.ramps.braking) + std::abs(velocity) * h;
  EXPECT_LE(std::abs(run.rig.drive().position - before), way + 1e-9);
  EXPECT_LE(std::abs(run.rig.command().position - before), way + 1e-9);
  EXPECT_EQ(run.rig.drive().velocity, 0.0);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  EXPECT_TRUE(run.loop.at_rest() && run.loop.held());
  if (moment.mode == Mode::safe) {
    EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << "the first reason is kept";
    EXPECT_EQ(run.loop.second().reason, Reason::stop_button);
    EXPECT_EQ(run.records.back().second, Reason::stop_button);
  } else {
    EXPECT_EQ(run.loop.trip().reason, Reason::stop_button);
    EXPECT_EQ(run.records.back().trip.reason, Reason::stop_button);
    EXPECT_EQ(run.records.back().trip.time, ms * moment.period);
    EXPECT_EQ(run.loop.second().reason, Reason::none) << "one press is one event";
  }
}

INSTANTIATE_TEST_SUITE_P(EachState, StopInState,
                         testing::Values(Moment{"Idle", Mode::idle, 2}, Moment{"ArmingAtRest", Mode::arming, 60},
                                         Moment{"ArmingProbe", Mode::arming, 350}, Moment{"Armed", Mode::armed, 1290},
                                         Moment{"Ready", Mode::ready, 1700}, Moment{"Running", Mode::running, 2600},
                                         Moment{"SlowingToHold", Mode::holding, 2900, 2500},
                                         Moment{"Holding", Mode::holding, 3600, 2500},
                                         Moment{"SafeOnTheWayBack", Mode::safe, 3500}),
                         [](const auto& each) { return each.param.name; });

// After a stop the rig stays where it stopped. On request, with the button up, it returns to rest with power, and loses
// that again there.
TEST(Stop, ReturnsToRestOnRequestOnly) {
  const Press press{{ms * 1300, ms * 1400}};
  Scene scene = bench();
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  lead(run, 1350);
  const double there = run.rig.drive().position;
  ASSERT_GT(there, 0.02);
  run.loop.go_to_rest();
  run.periods(10);
  EXPECT_FALSE(run.rig.enabled()) << "the button is still down";
  run.periods(100);
  EXPECT_EQ(run.rig.drive().position, there);
  run.loop.go_to_rest();
  run.periods(1);
  EXPECT_TRUE(run.rig.enabled());
  EXPECT_FALSE(run.loop.at_rest());
  run.periods(2000);
  EXPECT_EQ(run.rig.drive().position, 0.0);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button) << "nobody has acknowledged it";
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
}

// A press on the way back that was requested acts like any other.
TEST(Stop, ActsOnTheRequestedWayBack) {
  const std::array<Press, 2> presses{{{{ms * 1300, ms * 1310}}, {{ms * 1600, ms * 1601}}}};
  Scene scene = bench();
  scene.faults.presses = presses;
  Journey run{scene};
  lead(run, 1400);
  run.loop.go_to_rest();
  run.periods(200);
  ASSERT_TRUE(run.rig.enabled());
  const double there = run.rig.drive().position;
  run.periods(2000);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_TRUE(run.loop.held());
  EXPECT_NEAR(run.rig.drive().position, there, 0.15e-3) << "0.05 m/s for a period, and the braking distance";
}

// Limits hold while the command returns to rest: a second hazard there brakes, holds and takes the power. The hazard
// that led there may last.
TEST(Stop, SecondHazardOnTheWayBackBrakesAndHolds) {
  const std::array<ChannelFault, 2> faults{
      {{.kind = ChannelFault::Kind::drop, .channel = model::index(Channel::x_act), .window = {ms * 1300}},
       {.kind = ChannelFault::Kind::spike,
        .channel = model::index(Channel::F),
        .window = {ms * 1500, ms * 1501},
        .spike = 28e3}}};
  Scene scene = bench();
  scene.faults.channels = faults;
  Journey run{scene};
  lead(run, 1500);
  ASSERT_EQ(run.loop.trip().reason, Reason::sample_missing);
  ASSERT_TRUE(run.rig.enabled()) << "on the way back, with the sensor still lost";
  const double there = run.rig.command().position;
  run.periods(1);
  EXPECT_FALSE(run.rig.enabled());
  run.periods(1000);
  EXPECT_TRUE(run.loop.held());
  EXPECT_NEAR(run.rig.command().position, there, 0.15e-3);
  EXPECT_EQ(run.loop.trip().reason, Reason::sample_missing);
  EXPECT_EQ(run.loop.second().reason, Reason::force);
}

// Power is on while the loop leads the drive, until the command is at rest, and off otherwise: no command moves a drive
// without power.
TEST(DriveEnable, IsOnWhileTheLoopLeadsTheDrive) {
  Scene scene = bench();
  Journey run{scene};
  run.periods(3);
  EXPECT_FALSE(run.rig.enabled());
  run.loop.arm();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::armed);
  EXPECT_TRUE(run.rig.enabled());
  run.loop.disarm();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
  EXPECT_FALSE(run.rig.enabled());
  run.whole();
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_EQ(run.rig.drive().position, 0.0) << "power lasted until the command was at rest";
  for (const Record& row : run.records) {
    const bool led = leads_drive(row.mode) && row.trip.reason == Reason::none;
    EXPECT_TRUE(!led || row.enabled) << row.period;
    EXPECT_FALSE(row.mode == Mode::idle && row.enabled) << row.period;
  }
}

// Fault. Power that cannot be taken away is left to the watchdog: beats cease until the line takes writes again.
TEST(DriveEnable, ThatCannotBeWrittenIsLeftToTheWatchdog) {
  const std::array<DeviceFault, 1> faults{{{Device::drive_enable, Fault::disconnected, {ms * 1300, ms * 1400}}}};
  const Press press{{ms * 1350, ms * 1351}};
  Scene scene = bench();
  scene.faults.devices = faults;
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  lead(run, 1350);
  EXPECT_EQ(run.loop.mode(), Mode::running) << "nothing is written while nothing changes";
  const auto beats = run.rig.beats();
  run.periods(40);
  EXPECT_EQ(run.rig.beats(), beats);
  EXPECT_TRUE(run.rig.watchdog_has_acted());
  EXPECT_FALSE(run.loop.at_rest()) << "power may still be on";
  EXPECT_GT(run.loop.counters().failed_enables, 30U);
  run.periods(100);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_GT(run.rig.beats(), beats);
  EXPECT_TRUE(run.loop.at_rest());
}

// Fault. A beat that is not taken, or not given while the valves are lost, lets the watchdog take the power after 20
// ms; the next beat gives it back. So the program takes it as well, in that very period: in the run and on the way
// back, where the command would have gone on meanwhile. It stays off, whatever is asked for, until the fault is
// acknowledged and the rig is armed anew, without a jump.
TEST(DriveEnable, StaysOffOnceTheWatchdogMayHaveTakenThePower) {
  constexpr int run_period = 1300, return_period = 2100;
  for (const auto& [device, period, reason] : {std::tuple{Device::heartbeat, run_period, Reason::heartbeat_failed},
                                               std::tuple{Device::heartbeat, return_period, Reason::heartbeat_failed},
                                               std::tuple{Device::valves, return_period, Reason::valves_failed}}) {
    const DeviceFault fault{device, Fault::refused, {ms * period, ms * (period + 50)}};
    Scene scene = bench();
    scene.settings.arming.position_tolerance = 5e-3;
    scene.faults.devices = {&fault, 1};
    Journey run{scene};
    lead(run, period);
    ASSERT_TRUE(run.rig.enabled());
    const double there = run.rig.drive().position;
    ASSERT_GT(std::abs(there), 0.01);
    run.periods(1);
    EXPECT_FALSE(run.rig.enabled()) << period;
    EXPECT_LE(largest_step(run, 200), 0.05 * h) << "the beats come again meanwhile";
    run.loop.go_to_rest();
    EXPECT_LE(largest_step(run, 500), 1e-12);
    EXPECT_FALSE(run.rig.enabled());
    EXPECT_NEAR(run.rig.command().position, there, 0.15e-3) << "the command stays";
    EXPECT_EQ(period == run_period ? run.loop.trip().reason : run.loop.second().reason, reason);
    EXPECT_EQ(run.records.back().trip.reason, run.loop.trip().reason);
    run.loop.acknowledge();
    run.periods(1);
    run.loop.arm();
    EXPECT_LE(largest_step(run, 50), 1e-9);
    EXPECT_EQ(run.loop.mode(), Mode::armed);
    EXPECT_TRUE(run.rig.enabled());
  }
}

// Fault. A stop of the program for longer than the watchdog waits costs the power; it does not come back with the next
// beat.
TEST(DriveEnable, StaysOffAfterAGap) {
  const hal::simulated::LateWake late{{ms * 1300, ms * 1301}, hal::milliseconds(6000)};
  Scene scene = bench();
  scene.faults.late_wakes = {&late, 1};
  Journey run{scene};
  lead(run, 1300);
  ASSERT_TRUE(run.rig.enabled());
  run.periods(1);
  EXPECT_EQ(run.loop.trip().reason, Reason::gap);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_LE(largest_step(run, 1000), 1e-12);
}

// Fault. A drive that cannot be given power for the way back does not begin that way.
TEST(DriveEnable, ThatCannotBeSwitchedOnForTheWayBackHolds) {
  const Press press{{ms * 1300, ms * 1310}};
  const DeviceFault fault{Device::drive_enable, Fault::refused, {ms * 1600, ms * 1700}};
  Scene scene = bench();
  scene.faults.presses = {&press, 1};
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  lead(run, 1600);
  run.loop.go_to_rest();
  EXPECT_LE(largest_step(run, 1000), 1e-12);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button);
  EXPECT_EQ(run.loop.second().reason, Reason::enable_failed);
}

TEST(DriveEnable, ThatCannotBeSwitchedOnRefusesToArm) {
  const DeviceFault fault{Device::drive_enable, Fault::refused, {ms * 0, ms * 6}};
  Scene scene = bench();
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  lead(run, 6);
  EXPECT_EQ(run.loop.trip().reason, Reason::enable_failed);
  run.periods(10);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  EXPECT_FALSE(run.rig.enabled());
}

// Fault. An interlock that opens, however briefly, stops the rig where it is and takes the power; its number is on
// record. An open door keeps an idle rig from being armed, and no more.
TEST(Interlock, TakesThePowerAndIsNamed) {
  for (const int period : {7, 400, 1300, 2200}) {
    const OpenInterlock open{1, {hal::microseconds(1000 * period - 300), hal::microseconds(1000 * period - 200)}};
    Scene scene = bench();
    scene.faults.open_interlocks = {&open, 1};
    Journey run{scene};
    lead(run, period);
    ASSERT_TRUE(run.rig.enabled()) << period;
    const double there = run.rig.command().position;
    run.periods(1);
    EXPECT_FALSE(run.rig.enabled()) << period;
    run.periods(1000);
    EXPECT_NEAR(run.rig.command().position, there, 1e-3) << period;
    const firmware::Trip& trip = period == 2200 ? run.loop.second() : run.loop.trip();
    EXPECT_EQ(trip.reason, Reason::interlock) << period;
    EXPECT_EQ(trip.interlock, 1) << period;
  }
  const OpenInterlock door{0, {ms * 0, ms * 50}};
  Scene scene = bench();
  scene.faults.open_interlocks = {&door, 1};
  Journey run{scene};
  run.periods(4);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
  lead(run, 6);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  EXPECT_EQ(run.loop.trip().reason, Reason::interlock);
  EXPECT_EQ(run.loop.trip().interlock, 0);
}

TEST(Interlock, ThatCannotBeReadCountsAsOpen) {
  const DeviceFault fault{Device::interlocks, Fault::disconnected, {ms * 1300}};
  Scene scene = bench();
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  lead(run, 1301);
  EXPECT_EQ(run.loop.trip().reason, Reason::interlocks_lost);
  EXPECT_FALSE(run.rig.enabled());
}

// Fault. One contact alone stops the rig. When the other one has not followed within half a second the button is
// broken, and nobody can acknowledge that away.
TEST(StopChannels, ThatContradictEachOtherKeepTheRigInSafe) {
  const Press welded{{ms * 1300, ms * 2500}, Press::Contacts::first};
  Scene scene = bench();
  scene.faults.presses = {&welded, 1};
  Journey run{scene};
  lead(run, 1301);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button);
  run.periods(502);
  EXPECT_EQ(run.loop.second().reason, Reason::stop_channels);
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  run.periods(1000);
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
}

// A stop that is asked for is orderly in every state: a rig that nobody has armed has nothing to return from.
TEST(Stop, RequestIsOrderlyInEveryState) {
  for (const int period : {2, 7, 400, 1300}) {
    Journey run{bench()};
    lead(run, period);
    run.loop.stop();
    run.periods(2000);
    EXPECT_EQ(run.loop.trip().reason, Reason::stop_requested) << period;
    EXPECT_TRUE(run.loop.at_rest()) << period;
    EXPECT_EQ(run.rig.drive().position, 0.0) << period;
  }
}

}  // namespace
