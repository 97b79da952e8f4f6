// The way to safety: nothing on it gives power, no "off" is believed unread, limits and the stop act on the way back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/firmware/loop/rig_under_test.hpp"

namespace {
namespace way_to_safety {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using hal::simulated::ChannelFault;
using hal::simulated::Press;
using hal::simulated::Push;
using hal::simulated::StuckEnable;
using hal::simulated::StuckFeedback;
using model::RigKind;

/// A bench that stands `begin` from rest and runs from there: ready until about 1.5 · begin/0.05 m/s after the start.
Scene bench(double begin = 0.03, std::size_t samples = 1000) {
  Scene scene(RigKind::component_bench, samples);
  scene.reference = road(samples, 1.0, begin);
  scene.settings.arming.position_tolerance = 5e-3;
  return scene;
}

void lead(Journey& run, int periods, int arm = 300, int start = 310) {
  for (int k = 0; k < periods; ++k) {
    if (k == arm) run.loop.arm();
    if (k == start) run.loop.start();
    run.periods(1);
  }
}

/// So many periods; the way of the drive meanwhile [m], and whether it ever had power.
struct Seen {
  double way = 0.0;
  bool powered = false;
};
Seen watch(Journey& run, int periods) {
  Seen seen;
  const double from = run.rig.drive().position;
  for (int k = 0; k < periods; ++k) {
    run.periods(1);
    seen.way = std::max(seen.way, std::abs(run.rig.drive().position - from));
    seen.powered = seen.powered || run.rig.enabled();
  }
  return seen;
}

// Fault. Whatever ends an arming before it has given power, nothing moves and the enable stays off: a stop, a sample
// that is missing, a force beyond its limit. The drive stands 60 mm from rest.
TEST(WayToSafety, GivesNoPowerWhereThereWasNone) {
  const ChannelFault missing{
      .kind = ChannelFault::Kind::drop, .channel = model::index(Channel::F), .window = {ms * 320}};
  const ChannelFault force{
      .kind = ChannelFault::Kind::spike, .channel = model::index(Channel::F), .window = {ms * 320}, .spike = 26e3};
  for (const int what : {0, 1, 2}) {
    Scene scene = bench();
    scene.drive_at = 0.06;
    const hal::simulated::ReadBackError slow{0.02, {ms * 0, ms * 900}};  // the comparison waits for the converter
    scene.faults.read_back_errors = {&slow, 1};
    if (what == 1) scene.faults.channels = {&missing, 1};
    if (what == 2) scene.faults.channels = {&force, 1};
    Journey run{scene};
    lead(run, 320);
    ASSERT_EQ(run.loop.mode(), Mode::arming);
    ASSERT_FALSE(run.rig.enabled());
    if (what == 0) run.loop.stop();
    const Seen seen = watch(run, 2500);
    EXPECT_EQ(run.loop.mode(), Mode::safe) << what;
    EXPECT_FALSE(seen.powered) << what << ": " << name(run.loop.trip().reason);
    EXPECT_EQ(seen.way, 0.0) << what;
  }
}

// `rest` after a refused arming: two commands. It gives no power until an arming has passed.
TEST(WayToSafety, RestTakesAnArmingThatHasPassed) {
  Scene scene = bench();
  scene.drive_at = 0.06;
  scene.settings.arming.tare_time = 0.1;
  scene.settings.arming.preload = 2500.0;
  scene.settings.arming.probe_amplitude = 2e-3;
  scene.settings.arming.off_centre = true;
  scene.deviations.position_sign = 0.3;  // x_act answers with a third of the probe
  Journey run{scene};
  lead(run, 2500);
  ASSERT_EQ(run.loop.mode(), Mode::safe);
  ASSERT_GE(run.loop.trip().reason, Reason::arming_read_back) << name(run.loop.trip().reason);
  run.loop.go_to_rest();
  const Seen seen = watch(run, 2000);
  EXPECT_FALSE(seen.powered);
  EXPECT_LE(seen.way, 1e-12);
}

// Bumpless: a drive that has sunk by 1.5 mm since the press is met where it stands, and the command has not moved
// before.
TEST(WayToSafety, RestBeginsWhereTheDriveStands) {
  const Press press{{ms * 2000, ms * 2010}};
  const Push sinks{-1e-3, {ms * 2300, ms * 3800}};
  Scene scene = bench();
  scene.faults.presses = {&press, 1};
  scene.faults.pushes = {&sinks, 1};
  Journey run{scene};
  lead(run, 2100);
  ASSERT_EQ(run.loop.trip().reason, Reason::stop_button);
  const double commanded = run.rig.command().position, stood = run.rig.drive().position;
  run.periods(2500);
  EXPECT_EQ(run.rig.command().position, commanded) << "the command stays after a press";
  EXPECT_NEAR(run.rig.drive().position, stood - 1.5e-3, 1e-6);
  run.loop.go_to_rest();
  EXPECT_LE(largest_step(run, 2500), 0.05 * h * (1.0 + 1e-9)) << "no jump of 1.5 mm";
  EXPECT_NEAR(run.rig.drive().position, 0.0, 1e-9);
  EXPECT_FALSE(run.rig.enabled());
}

// Fault. The enable's relay is welded and x_act is 1 mm off. After a press, and in an idle session before any arming,
// the drive moves by no more than the braking takes, since no command follows x_act.
TEST(WayToSafety, AWeldedRelayMovesNothingByTheCommand) {
  const StuckEnable welded{true, {ms * 0}};
  const Press press{{ms * 2000, ms * 2010}};
  for (const bool idle : {true, false}) {
    Scene scene = bench();
    scene.deviations.position_offset = 1e-3;
    scene.faults.stuck_enables = {&welded, 1};
    if (!idle) scene.faults.presses = {&press, 1};
    Journey run{scene};
    if (!idle) lead(run, 2010);
    const Seen seen = watch(run, 4000);
    EXPECT_LE(seen.way, 1e-4) << idle;
  }
}

// Fault. With the contact that shows the power, a welded relay is found 0.2 s after power was to go, or at once in
// idle: beats cease, and the watchdog takes the supply. So is a relay that does not close, and a broken contact.
TEST(WayToSafety, TheContactShowsARelayThatDoesNotDoWhatItIsTold) {
  const Press press{{ms * 2000, ms * 2010}};
  const StuckEnable welded{true, {ms * 1500}}, open{false, {ms * 1500}}, welded_at_first{true, {ms * 0}};
  const StuckFeedback broken{false, {ms * 1500}};
  struct Case {
    const char* name;
    const StuckEnable* enable;
    const StuckFeedback* feedback;
    int found;  ///< [ms]
    bool second;
  };
  for (const Case& c :
       {Case{"welded", &welded, nullptr, 2200, true}, Case{"does not close", &open, nullptr, 1700, false},
        Case{"contact broken", nullptr, &broken, 1700, false},
        Case{"welded in idle", &welded_at_first, nullptr, 200, false}}) {
    Scene scene = bench();
    scene.enable_feedback = true;
    scene.faults.presses = {&press, 1};
    if (c.enable != nullptr) scene.faults.stuck_enables = {c.enable, 1};
    if (c.feedback != nullptr) scene.faults.stuck_feedbacks = {c.feedback, 1};
    Journey run{scene};
    lead(run, c.found - 5);
    const firmware::Trip& trip = c.second ? run.loop.second() : run.loop.trip();
    EXPECT_NE(trip.reason, Reason::enable_feedback) << c.name;
    run.periods(10);
    EXPECT_EQ(trip.reason, Reason::enable_feedback) << c.name;
    const auto beats = run.rig.beats();
    run.periods(100);
    EXPECT_EQ(run.rig.beats(), beats) << c.name << ": the heartbeat is taken";
    EXPECT_FALSE(run.rig.powered()) << c.name;
    run.loop.go_to_rest();
    run.loop.arm();
    run.periods(100);
    EXPECT_FALSE(run.loop.enabled()) << c.name;
  }
  Scene sound = bench();
  sound.enable_feedback = true;
  Journey run{sound};
  lead(run, 6000);
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << "a sound contact trips nothing";
  EXPECT_EQ(run.loop.second().reason, Reason::none);
}

// Fault. Without that contact, motion shows it: a drive without power that moves by more than 2 mm trips in every
// state, takes the heartbeat and is not at rest. A load that sinks by 1 mm/s does not.
TEST(WayToSafety, MotionWithoutPowerTripsInEveryState) {
  const Press press{{ms * 1500, ms * 1510}};
  struct Case {
    int pushed;
    double speed;
    Mode mode;
    bool trips;
  };
  for (const Case& c : {Case{250, 5e-3, Mode::idle, true}, Case{320, 5e-3, Mode::arming, true},
                        Case{2500, 5e-3, Mode::safe, true}, Case{2500, 1e-3, Mode::safe, false}}) {
    const Push push{c.speed, {ms * c.pushed, ms * (c.pushed + 4000)}};
    const hal::simulated::ReadBackError slow{0.02, {ms * 300, ms * 1400}};
    Scene scene = bench();
    scene.faults.pushes = {&push, 1};
    if (c.mode == Mode::arming) scene.faults.read_back_errors = {&slow, 1};
    if (c.mode == Mode::safe) scene.faults.presses = {&press, 1};
    Journey run{scene};
    lead(run, c.pushed + 50, c.mode == Mode::idle ? 100'000 : 300);
    ASSERT_EQ(run.loop.mode(), c.mode);
    const double from = run.rig.drive().position;
    bool rested = false;
    int periods = 0;
    while (periods++ < 3000 && run.loop.trip().reason != Reason::motion_without_power &&
           run.loop.second().reason != Reason::motion_without_power) {
      run.periods(1);
      rested = run.loop.at_rest();
    }
    EXPECT_EQ(periods < 3000, c.trips) << name(c.mode);
    if (!c.trips) continue;
    // x − x̄ of a speed v is v T (1 − e^(−t/T)): 2 mm of 5 mm/s after 0.51 s.
    EXPECT_LE(std::abs(run.rig.drive().position - from), 5e-3 * 0.52) << name(c.mode);
    EXPECT_FALSE(rested) << name(c.mode);
    const auto beats = run.rig.beats();
    run.periods(50);
    EXPECT_EQ(run.rig.beats(), beats) << name(c.mode);
    run.loop.acknowledge();
    run.periods(5);
    EXPECT_EQ(run.loop.mode(), Mode::safe) << "it still moves";
  }
}

// Fault. A force beyond its limit ends the run; on the way back it may fall. One that grows, by a jammed rig, ends the
// way back too: no power, and both reasons on record.
TEST(WayToSafety, AForceThatGrowsOnTheWayBackTakesThePower) {
  for (const bool grows : {true, false}) {
    const std::array<ChannelFault, 2> faults{
        {{.kind = ChannelFault::Kind::spike, .channel = model::index(Channel::F), .window = {ms * 2000}, .spike = 12e3},
         {.kind = ChannelFault::Kind::spike,
          .channel = model::index(Channel::F),
          .window = {ms * 2200, grows ? ms * 20'000 : ms * 2200},
          .spike = 1e3}}};
    Scene scene = bench();
    scene.settings.limits.force = 9000.0;
    scene.faults.channels = faults;
    Journey run{scene};
    lead(run, 2190);
    ASSERT_EQ(run.loop.trip().reason, Reason::force);
    ASSERT_TRUE(run.rig.enabled()) << "on the way back, the force as it was";
    const double there = run.rig.drive().position;
    run.periods(20);
    EXPECT_EQ(run.rig.enabled(), !grows);
    EXPECT_EQ(run.loop.second().reason, grows ? Reason::force : Reason::none);
    run.periods(2000);
    EXPECT_EQ(run.loop.held(), grows);
    if (grows) {
      EXPECT_NEAR(run.rig.drive().position, there, 1.5e-3);
      EXPECT_EQ(run.records.back().second, Reason::force);
      EXPECT_EQ(run.records.back().trip.reason, Reason::force);
    } else {
      EXPECT_NEAR(run.rig.drive().position, 0.0, 1e-9);
    }
  }
}

// Fault. In the approach half of the force limit is enough: the drive brakes, holds and has no power.
TEST(WayToSafety, AForceInTheApproachHolds) {
  const ChannelFault push{
      .kind = ChannelFault::Kind::spike, .channel = model::index(Channel::F), .window = {ms * 600}, .spike = 14e3};
  Scene scene = bench();
  scene.faults.channels = {&push, 1};
  Journey run{scene};
  lead(run, 601);
  EXPECT_EQ(run.loop.trip().reason, Reason::force);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_TRUE(run.loop.held());
}

// Fault. A sensor that was lost and stays so hides no other: the second one ends the way back.
TEST(WayToSafety, ALostSensorHidesNoOther) {
  const std::array<ChannelFault, 2> faults{
      {{.kind = ChannelFault::Kind::drop, .channel = model::index(Channel::x_act), .window = {ms * 2000}},
       {.kind = ChannelFault::Kind::drop, .channel = model::index(Channel::F), .window = {ms * 2200}}}};
  Scene scene = bench();
  scene.faults.channels = faults;
  Journey run{scene};
  lead(run, 2200);
  ASSERT_EQ(run.loop.trip().reason, Reason::sample_missing);
  ASSERT_TRUE(run.rig.enabled());
  run.periods(5);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_EQ(run.loop.second().reason, Reason::sample_missing);
  EXPECT_EQ(run.loop.second().channel, Channel::F);
}

// The first stop brakes and returns; the second, or one on a return for another reason, brakes and holds for good. The
// program's own end does not.
TEST(WayToSafety, ASecondStopBrakesAndHolds) {
  for (const bool asked : {true, false}) {
    for (const bool person : {true, false}) {
      Scene scene = bench(0.03, asked ? 5000 : 1000);
      Journey run{scene};
      lead(run, 2000);
      ASSERT_EQ(run.loop.mode(), Mode::running);
      if (asked) run.loop.stop();
      while (run.loop.mode() != Mode::safe) run.periods(1);
      run.periods(100);
      ASSERT_TRUE(run.rig.enabled());
      const double there = run.rig.drive().position;
      ASSERT_GT(there, 0.01);
      if (person) {
        run.loop.stop();
      } else {
        run.loop.end();
      }
      const Seen seen = watch(run, 3000);
      EXPECT_EQ(seen.way <= 0.15e-3, person) << seen.way;
      EXPECT_EQ(run.loop.held(), person);
      EXPECT_EQ(run.loop.second().reason, person ? Reason::stop_requested : Reason::none);
      EXPECT_FALSE(run.rig.enabled());
    }
  }
}

// A stop acts on the way back that a person has asked for, too.
TEST(WayToSafety, AStopActsOnTheRequestedWayBack) {
  const Press press{{ms * 2000, ms * 2010}};
  Scene scene = bench();
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  lead(run, 2500);
  run.loop.go_to_rest();
  run.periods(200);
  ASSERT_TRUE(run.rig.enabled());
  run.loop.stop();
  const Seen seen = watch(run, 2000);
  EXPECT_LE(seen.way, 0.15e-3);
  EXPECT_TRUE(run.loop.held());
  run.loop.go_to_rest();
  EXPECT_GT(watch(run, 2500).way, 0.01) << "a person may ask again";
}

// A level that is asked for while the rig holds is taken when it goes on: holding stands still.
TEST(WayToSafety, ALevelMovesNoHoldingRig) {
  for (const int before : {0, 500}) {  // a change under way when the rig is held stands still with it
    Scene scene = bench(0.0, 8000);
    scene.reference = road(8000, 10.0);
    Journey run{scene};
    lead(run, 2200 - before);
    ASSERT_EQ(run.loop.mode(), Mode::running);
    if (before > 0) {
      EXPECT_TRUE(run.loop.level(0.3));
    }
    run.periods(static_cast<std::size_t>(before));
    run.loop.hold();
    run.periods(1100);
    ASSERT_EQ(run.loop.mode(), Mode::holding);
    EXPECT_TRUE(run.loop.level(0.0));
    EXPECT_EQ(watch(run, 2000).way, 0.0);
    run.loop.resume();
    run.periods(3500);
    EXPECT_EQ(run.records.back().level, 0.0);
    EXPECT_LE(largest_step(run, 100), 1e-12);
  }
}

}  // namespace way_to_safety
}  // namespace
