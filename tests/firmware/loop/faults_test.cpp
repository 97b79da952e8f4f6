// Every fault that a simulated rig can have, and where it must end: valves safe, command at rest, reason on record.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/firmware/loop/rig_under_test.hpp"

namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using hal::Fault;
using hal::simulated::ChannelFault;
using hal::simulated::DeviceFault;
using hal::simulated::LateWake;
using hal::simulated::Press;
using hal::simulated::Window;
using Kind = ChannelFault::Kind;
using Device = DeviceFault::Device;
using model::RigKind;

constexpr Window from_300{ms * 300};

struct FaultCase {
  std::string what;
  RigKind kind;
  std::optional<ChannelFault> channel;
  std::optional<DeviceFault> device;
  std::optional<Press> press;
  Reason reason;
  std::optional<Channel> where;
  int trips_at;  ///< sample of the run
};

std::string sentence(const testing::TestParamInfo<FaultCase>& info) { return info.param.what; }

class Faults : public testing::TestWithParam<FaultCase> {};

ChannelFault fault_of(Channel channel, Kind kind, double spike = 0.0, unsigned delay = 0) {
  return {.kind = kind, .channel = model::index(channel), .window = from_300, .delay_samples = delay, .spike = spike};
}

// Fault. In the middle of a run something fails for good: the run ends at the sample that the limits promise, for the
// reason that is true, at the channel that failed, and the rig comes to rest.
TEST_P(Faults, EndWithTheRigAtRestAndTheReasonOnRecord) {
  const FaultCase& c = GetParam();
  Scene scene(c.kind, 1000);
  if (c.channel) scene.faults.channels = {&*c.channel, 1};
  if (c.device) scene.faults.devices = {&*c.device, 1};
  if (c.press) scene.faults.presses = {&*c.press, 1};
  Journey run{scene};
  run.whole();
  run.periods(30);  // time for the watchdog
  const auto& trip = run.loop.trip();
  EXPECT_EQ(trip.reason, c.reason) << name(trip.reason);
  EXPECT_TRUE(is_fault(trip.reason));
  EXPECT_EQ(trip.channel, c.where);
  EXPECT_EQ(trip.time, ms * c.trips_at);
  const auto rows = run.rows(Mode::running);
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.back().sample, static_cast<std::uint64_t>(c.trips_at));
  EXPECT_EQ(run.records.back().trip.reason, c.reason) << "in the journal, too";
  EXPECT_EQ(run.records.back().trip.time, trip.time);
  if (c.what != "ValvesFail" && c.what != "CommandRefused" && c.what != "CommandTimesOut") expect_safe_end(run);
  EXPECT_EQ(run.rig.openings(), scene.safe_position);
}

// A bad sample is bridged twice: 300, 301, tripping at 302. Frozen and delayed samples carry old stamps: 5 periods old
// is young enough, so freezing trips 6 + 2 samples on, a delay of 10 at once with two bridged.
INSTANTIATE_TEST_SUITE_P(
    EveryKind, Faults,
    testing::Values(
        FaultCase{"ForceDrops",
                  RigKind::hil,
                  fault_of(Channel::F, Kind::drop),
                  {},
                  {},
                  Reason::sample_missing,
                  Channel::F,
                  302},
        FaultCase{"ForceFreezes",
                  RigKind::hil,
                  fault_of(Channel::F, Kind::freeze),
                  {},
                  {},
                  Reason::sample_stale,
                  Channel::F,
                  308},
        FaultCase{"ForceIsLate",
                  RigKind::hil,
                  fault_of(Channel::F, Kind::delay, 0.0, 10),
                  {},
                  {},
                  Reason::sample_stale,
                  Channel::F,
                  302},
        FaultCase{"ForceIsNoNumber",
                  RigKind::hil,
                  fault_of(Channel::F, Kind::not_a_number),
                  {},
                  {},
                  Reason::sample_not_finite,
                  Channel::F,
                  302},
        FaultCase{"ForceBeyondItsLimit",
                  RigKind::hil,
                  fault_of(Channel::F, Kind::spike, 26e3),
                  {},
                  {},
                  Reason::force,
                  Channel::F,
                  300},
        FaultCase{"ForceBeyondItsRange",
                  RigKind::hil,
                  fault_of(Channel::F, Kind::spike, 40e3),
                  {},
                  {},
                  Reason::sample_clipped,
                  Channel::F,
                  302},
        FaultCase{"WheelAccelerationDrops",
                  RigKind::quarter_car,
                  fault_of(Channel::zdd_w, Kind::drop),
                  {},
                  {},
                  Reason::sample_missing,
                  Channel::zdd_w,
                  302},
        FaultCase{"WheelLoadBeyondItsRange",
                  RigKind::quarter_car,
                  fault_of(Channel::F_w, Kind::spike, -11e3),
                  {},
                  {},
                  Reason::sample_clipped,
                  Channel::F_w,
                  302},
        FaultCase{"LaserFreezes",
                  RigKind::quarter_car,
                  fault_of(Channel::dz_b, Kind::freeze),
                  {},
                  {},
                  Reason::sample_stale,
                  Channel::dz_b,
                  308},
        FaultCase{"DeflectionIsNoNumber",
                  RigKind::component_bench,
                  fault_of(Channel::x_act, Kind::not_a_number),
                  {},
                  {},
                  Reason::sample_not_finite,
                  Channel::x_act,
                  302},
        FaultCase{"SensorsTimeOut",
                  RigKind::hil,
                  {},
                  DeviceFault{Device::sensors, Fault::timeout, from_300},
                  {},
                  Reason::sample_missing,
                  Channel::x_act,
                  302},
        FaultCase{"SensorsDisconnect",
                  RigKind::hil,
                  {},
                  DeviceFault{Device::sensors, Fault::disconnected, from_300},
                  {},
                  Reason::sensors_lost,
                  {},
                  300},
        FaultCase{"ValvesFail",
                  RigKind::hil,
                  {},
                  DeviceFault{Device::valves, Fault::refused, from_300},
                  {},
                  Reason::valves_failed,
                  {},
                  300},
        FaultCase{"CommandRefused",
                  RigKind::component_bench,
                  {},
                  DeviceFault{Device::command, Fault::refused, Window{ms * 300, ms * 400}},
                  {},
                  Reason::command_failed,
                  {},
                  300},
        FaultCase{"CommandTimesOut",
                  RigKind::component_bench,
                  {},
                  DeviceFault{Device::command, Fault::timeout, Window{ms * 300, ms * 400}},
                  {},
                  Reason::command_failed,
                  {},
                  302},
        FaultCase{"HeartbeatFails",
                  RigKind::hil,
                  {},
                  DeviceFault{Device::heartbeat, Fault::disconnected, from_300},
                  {},
                  Reason::heartbeat_failed,
                  {},
                  300},
        FaultCase{"StopButtonPressed", RigKind::hil, {}, {}, Press{{ms * 300, ms * 301}}, Reason::stop_button, {}, 300},
        FaultCase{"StopButtonPressedBetweenPeriods",
                  RigKind::quarter_car,
                  {},
                  {},
                  Press{{hal::microseconds(299'100), hal::microseconds(299'200)}},
                  Reason::stop_button,
                  {},
                  300},
        FaultCase{"StopButtonLost",
                  RigKind::component_bench,
                  {},
                  DeviceFault{Device::stop_button, Fault::disconnected, from_300},
                  {},
                  Reason::stop_button_lost,
                  {},
                  300}),
    sentence);

// Two bad samples of three are bridged: the run goes on, the bridging is counted, and the journal shows the samples as
// they were read, marked.
TEST(Faults, ShortOnesAreBridgedAndCounted) {
  const ChannelFault nan{
      .kind = Kind::not_a_number, .channel = model::index(Channel::F), .window = {ms * 300, ms * 302}};
  Scene scene(RigKind::hil, 600);
  scene.faults.channels = {&nan, 1};
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended);
  EXPECT_EQ(run.loop.counters().bridged_samples, 2U);
  const auto rows = run.rows(Mode::running);
  EXPECT_EQ(rows[299].bridged, 0U);
  EXPECT_EQ(rows[300].bridged, 1U << model::index(Channel::F));
  EXPECT_TRUE(std::isnan(value(rows[301], Channel::F)));
  EXPECT_EQ(rows[302].bridged, 0U);
  EXPECT_FALSE(std::isnan(rows[302].command.position))
      << "what was read is on record, what was used is the last good one";
}

// A frame that is late twice is bridged in every channel.
TEST(Faults, FramesThatTimeOutAreCounted) {
  const DeviceFault fault{Device::sensors, Fault::timeout, {ms * 100, ms * 102}};
  Scene scene(RigKind::hil, 200);
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended);
  EXPECT_EQ(run.loop.counters().missed_frames, 2U);
  EXPECT_EQ(run.loop.counters().bridged_samples, 4U) << "F and x_act";
}

// A drive that misses a command now and then keeps its last one: counted, not ended.
TEST(Faults, SingleCommandsThatTimeOutAreCounted) {
  const std::array<DeviceFault, 2> faults{{{Device::command, Fault::timeout, {ms * 100, ms * 102}},
                                           {Device::command, Fault::timeout, {ms * 103, ms * 105}}}};
  Scene scene(RigKind::component_bench, 200);
  scene.faults.devices = faults;
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended);
  EXPECT_EQ(run.loop.counters().failed_commands, 4U);
}

// Random bits turned over in every channel, seeded: whatever happens, no command leaves the limits, and the run ends in
// safe one way or another.
TEST(Faults, NoFlippedBitMovesTheRigBeyondItsLimits) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::vector<ChannelFault> flips;
    for (const Channel c : {Channel::F, Channel::x_act}) {
      flips.push_back({.kind = Kind::bit_flip, .channel = model::index(c), .probability = 0.05});
    }
    Scene scene(RigKind::hil, 1500);
    scene.faults.channels = flips;
    scene.faults.seed = seed;
    Journey run{scene};
    run.whole();
    ASSERT_TRUE(run.loop.mode() == Mode::safe && run.loop.at_rest()) << "seed " << seed;
    double last = 0.0;
    for (const Record& row : run.records) {
      ASSERT_TRUE(std::isfinite(row.command.position)) << "seed " << seed;
      ASSERT_LE(std::abs(row.command.position), half_stroke) << "seed " << seed;
      ASSERT_LE(std::abs(row.command.position - last), speed_limit * h * (1.0 + 1e-9)) << "seed " << seed;
      last = row.command.position;
    }
  }
}

// The stroke of the drive is the last thing to learn by trying: the command beyond it never goes out.
TEST(Faults, CommandBeyondTheStrokeTripsAtOnce) {
  Scene scene(RigKind::component_bench, 3000);
  for (std::size_t k = 0; k < scene.reference.size(); ++k) {
    const double t = h * static_cast<double>(k);
    scene.reference[k] = {0.1 * t, 0.1, 0.0};  // reaches 125 mm at 1.25 s
  }
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::stroke);
  EXPECT_NEAR(run.loop.trip().value, 0.1251, 1e-12);
  EXPECT_EQ(run.loop.trip().limit, 0.125);
  EXPECT_EQ(run.loop.trip().time, ms * 1250) << "the command for 1251 ms";
  expect_safe_end(run);
}

TEST(Faults, CommandTooFastIsSlowedDownThenTrips) {
  Scene scene(RigKind::component_bench, 1000);
  for (std::size_t k = 0; k < scene.reference.size(); ++k) {
    scene.reference[k] = {k < 100 ? 0.0 : -0.11, 0.0, 0.0};
  }
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::speed);
  EXPECT_EQ(run.loop.trip().time, ms * (99 + 50)) << "the command of 99 is for sample 100; the 51st of 51 trips";
  EXPECT_EQ(run.loop.counters().limited_commands, 51U);
  expect_safe_end(run);
}

TEST(Faults, ReferenceThatIsNoNumberTrips) {
  Scene scene(RigKind::hil, 1000);
  scene.reference[500].velocity = std::nan("");
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::command_not_finite);
  EXPECT_EQ(run.loop.trip().time, ms * 499);
  expect_safe_end(run);
}

// An unstable loop is the fault this rig is known for: at 700 N s/m and 10 ms the wheel mode grows, and the limits end
// it.
TEST(Faults, UnstableLoopIsCaughtByTheLimits) {
  Scene scene(RigKind::hil, 20'000);
  scene.parameters.effects.add<model::ActuatorDelay>({0.010});
  scene.parameters.machine.virtual_damping = 700.0;
  Journey run{scene};
  run.whole();
  EXPECT_TRUE(is_fault(run.loop.trip().reason)) << name(run.loop.trip().reason);
  expect_safe_end(run);
}

// Valves that cannot be written are left to the watchdog: the program stops beating, and once they take writes again
// they get the safe position.
TEST(Faults, LostValvesAreLeftToTheWatchdog) {
  const DeviceFault fault{Device::valves, Fault::refused, {ms * 300, ms * 400}};
  Scene scene(RigKind::hil, 1000);
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  run.loop.arm();
  run.loop.start();
  run.periods(310);
  EXPECT_EQ(run.loop.trip().reason, Reason::valves_failed);
  EXPECT_EQ(run.rig.beats(), 300U);
  EXPECT_FALSE(run.rig.watchdog_has_acted());
  run.periods(11);
  EXPECT_TRUE(run.rig.watchdog_has_acted()) << "20 ms after the last beat";
  EXPECT_EQ(run.rig.openings(), scene.safe_position);
  run.periods(100);
  EXPECT_FALSE(run.rig.watchdog_has_acted()) << "valves and beats are back";
  EXPECT_EQ(run.rig.openings(), scene.safe_position);
  EXPECT_EQ(run.loop.counters().failed_valves, 101U) << "twice in the period of the trip";
}

// The period in which valves fail is already the first of the way to rest: neither the command of the run nor its
// openings are put out any more.
TEST(Faults, LostValvesEndTheRunInTheirVeryPeriod) {
  const DeviceFault fault{Device::valves, Fault::refused, {ms * 100, ms * 101}};
  Scene scene(RigKind::component_bench, 1000);
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  run.whole();
  const Record row = run.rows(Mode::running).back();
  ASSERT_EQ(row.sample, 100U);
  const double now = scene.reference[100].position;
  firmware::ReturnToRest way(now, (now - scene.reference[99].position) / h, scene.settings.ramps, half_stroke, h);
  EXPECT_EQ(row.command, way.next());
  EXPECT_EQ(row.openings, scene.safe_position);
}

// Whatever ends the run ends it with safe valves in the same period, also when the openings had gone out already.
TEST(Faults, ValvesAreSafeInThePeriodOfTheTrip) {
  for (const Device device : {Device::command, Device::heartbeat}) {
    const DeviceFault fault{device, Fault::refused, {ms * 100}};
    Scene scene(RigKind::hil, 1000);
    scene.faults.devices = {&fault, 1};
    Journey run{scene};
    run.loop.arm();
    run.loop.start();
    run.periods(100);
    EXPECT_EQ(run.rig.openings(), hal::Openings::first(2));
    run.periods(1);
    EXPECT_EQ(run.loop.mode(), Mode::safe);
    EXPECT_EQ(run.rig.openings(), scene.safe_position);
    EXPECT_EQ(run.records.back().openings, scene.safe_position);
    EXPECT_EQ(run.loop.counters().failed_beats, device == Device::heartbeat ? 1U : 0U);
    EXPECT_EQ(run.loop.counters().failed_commands, device == Device::command ? 1U : 0U);
  }
}

// A drive that takes nothing for a while must not be met by a jump when it is back: it stays where it was, without
// power.
TEST(Faults, DriveThatComesBackStaysWhereItWas) {
  const DeviceFault fault{Device::command, Fault::refused, {ms * 300, ms * 700}};
  Scene scene(RigKind::component_bench, 1000);
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  run.loop.arm();
  run.loop.start();
  double last = 0.0;
  for (int k = 0; k < 3000; ++k) {
    run.periods(1);
    EXPECT_LE(std::abs(run.rig.command().position - last), speed_limit * h * (1.0 + 1e-9)) << k;
    last = run.rig.command().position;
  }
  EXPECT_EQ(run.rig.command().position, scene.reference[300].position);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_EQ(run.loop.counters().failed_commands, 400U);
}

// A start with a fault present is refused with its reason; the rig has not moved.
TEST(Faults, StartWithoutSoundSensorsEndsInSafe) {
  const ChannelFault drop{.kind = Kind::drop, .channel = model::index(Channel::F)};
  Scene scene(RigKind::hil, 100);
  scene.faults.channels = {&drop, 1};
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::sample_missing);
  EXPECT_TRUE(run.rows(Mode::running).empty());
  for (const Record& row : run.records) EXPECT_EQ(row.command, hal::Command{});
}

// A press while the rig is idle leads to safe, and nothing moves until somebody acknowledges.
TEST(Faults, PressBeforeTheStartIsRemembered) {
  const Press press{{ms * 10, ms * 11}};
  Scene scene(RigKind::component_bench, 100);
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  run.periods(50);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button);
  EXPECT_EQ(run.loop.trip().time, ms * 10);
  run.whole();
  EXPECT_TRUE(run.rows(Mode::running).empty());
  run.loop.acknowledge();
  run.periods(1);
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended);
}

// The latch of the stop button is released by the acknowledgement; while somebody still holds it, there is no way on.
TEST(Faults, HeldStopButtonKeepsTheRigInSafe) {
  const Press press{{ms * 100, ms * 1500}};
  Scene scene(RigKind::component_bench, 1000);
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  run.loop.arm();
  run.loop.start();
  run.periods(1000);
  ASSERT_TRUE(run.loop.at_rest());
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button);
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::safe) << "still held";
  run.periods(600);
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
}

// A journal that nobody reads loses records and says how many; the loop has not noticed.
TEST(Faults, JournalThatNobodyReadsIsCounted) {
  Scene scene(RigKind::quarter_car, 500);
  Journey attentive{scene};
  attentive.whole();
  Journey sleeping{scene};
  sleeping.loop.arm();
  sleeping.loop.start();
  const std::size_t total = attentive.records.size();
  for (std::size_t k = 0; k < total; ++k) {
    sleeping.rig.roles().clock.sleep_until(sleeping.loop.due());
    sleeping.loop.step();
  }
  EXPECT_EQ(sleeping.journal.lost(), total - 64);
  EXPECT_EQ(sleeping.rig.command(), attentive.rig.command());
  EXPECT_EQ(sleeping.loop.trip().reason, attentive.loop.trip().reason);
}

}  // namespace
