// The stop button, the drive's enable and the interlocks, in every state.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

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

struct Moment {
  Mode mode;
  int period;  ///< of the press
};

/// Somewhere in each state, with the command moving where the state moves it.
constexpr std::array moments{Moment{Mode::idle, 2}, Moment{Mode::armed, 7}, Moment{Mode::ready, 400},
                             Moment{Mode::running, 1300}, Moment{Mode::safe, 2200}};

/// Idle, armed from period 5, started at 10, run to its end.
void lead(Journey& run, int periods) {
  for (int k = 0; k < periods; ++k) {
    if (k == 5) run.loop.arm();
    if (k == 10) run.loop.start();
    run.periods(1);
  }
}

// Fault. Pressed in any state: no power from that very period on, the command stops within the braking distance and
// stays there, valves safe, and the record says so. At 20 m/s² 0.05 m/s stop within 63 µm and 3 periods.
TEST(Stop, BrakesHoldsAndTakesThePowerInEveryState) {
  for (const Moment& moment : moments) {
    const Press press{{ms * moment.period, ms * (moment.period + 1)}};
    Scene scene = bench();
    scene.faults.presses = {&press, 1};
    Journey run{scene};
    lead(run, moment.period);
    ASSERT_EQ(run.loop.mode(), moment.mode) << name(moment.mode);
    const double before = run.rig.command().position, velocity = run.records.back().command.velocity;
    run.periods(1);
    EXPECT_EQ(run.loop.mode(), Mode::safe) << name(moment.mode);
    EXPECT_FALSE(run.rig.enabled()) << name(moment.mode);
    EXPECT_EQ(run.rig.openings(), scene.safe_position);
    EXPECT_FALSE(run.records.back().enabled);
    lead(run, 1500);  // nothing that is asked for now starts anything
    const double way = velocity * velocity / (2.0 * scene.settings.ramps.braking) + std::abs(velocity) * h;
    EXPECT_LE(std::abs(run.rig.drive().position - before), way + 1e-12) << name(moment.mode);
    EXPECT_LE(std::abs(run.rig.command().position - before), way + 1e-12) << name(moment.mode);
    EXPECT_EQ(run.rig.drive().velocity, 0.0);
    EXPECT_EQ(run.loop.mode(), Mode::safe);
    EXPECT_TRUE(run.loop.at_rest() && run.loop.held()) << name(moment.mode);
    if (moment.mode == Mode::safe) {
      EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << "the first reason is kept";
      EXPECT_EQ(run.loop.second().reason, Reason::stop_button);
      EXPECT_EQ(run.records.back().second, Reason::stop_button);
    } else {
      EXPECT_EQ(run.loop.trip().reason, Reason::stop_button) << name(moment.mode);
      EXPECT_EQ(run.records.back().trip.time, ms * moment.period);
      EXPECT_EQ(run.loop.second().reason, Reason::none) << "one press is one event";
    }
  }
}

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
