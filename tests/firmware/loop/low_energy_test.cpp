// Little energy first: slow motions are slow, pressure follows proof, a hand may be needed, the stop button is tried.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "firmware/loop/guards/motion_guard.hpp"
#include "tests/firmware/loop/rig_under_test.hpp"
#include "tests/firmware/loop/silent_sensors.hpp"

namespace low_energy_test {
namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using hal::simulated::DeviceFault;
using hal::simulated::OpenInterlock;
using hal::simulated::Press;
using model::RigKind;

Scene looked_at(RigKind kind, std::size_t samples = 1000) {
  Scene scene(kind, samples);
  scene.settings.arming.tare_time = 0.1;
  scene.settings.arming.preload = 2500.0;
  scene.settings.arming.position_tolerance = 5e-3;
  scene.settings.arming.probe_amplitude = 2e-3;
  return scene;
}

void until(Journey& run, int instant) { run.periods(static_cast<std::size_t>(instant - run.rig.now().ns / 1'000'000)); }

// Point. The second stage of a power unit follows only behind the probe, and goes first: a trip that leads back to rest
// does so with the low one, and after a press it is gone with the power.
TEST(LowEnergy, HighPressureFollowsProofAndGoesFirst) {
  for (const bool pressed : {false, true}) {
    Scene scene = looked_at(RigKind::hil, 9000);
    scene.high_pressure = true;
    const Press press{{ms * 5000, ms * 5010}};
    if (pressed) scene.faults.presses = {&press, 1};
    Journey run{scene};
    run.loop.arm();
    bool returned = false;
    for (int k = 0; k < 7000; ++k) {
      run.periods(1);
      const Mode mode = run.loop.mode();
      const bool proven = mode == Mode::armed || mode == Mode::ready || mode == Mode::running;
      ASSERT_EQ(run.rig.high_pressure(), proven) << k << " in " << name(mode);
      if (proven) {
        ASSERT_TRUE(run.rig.enabled()) << k;
      }
      if (mode == Mode::armed) run.loop.start();
      if (k == 5500) run.loop.stop();
      returned = returned || (mode == Mode::safe && run.rig.enabled());
    }
    EXPECT_EQ(run.loop.trip().reason, pressed ? Reason::stop_button : Reason::stop_requested);
    EXPECT_EQ(returned, !pressed);
  }
}

// Fault. Whether the second stage is off cannot be known where its line takes no writes: as with the enable, the power
// is withdrawn and the watchdog takes the supply.
TEST(LowEnergy, AHighPressureThatIsNotWrittenTrips) {
  Scene scene = looked_at(RigKind::hil, 4000);
  scene.high_pressure = true;
  const DeviceFault fault{DeviceFault::Device::high_pressure, hal::Fault::refused, {ms * 100}};
  scene.faults.devices = {&fault, 1};
  Journey run{scene};
  run.periods(50);
  run.loop.arm();
  run.periods(3000);
  EXPECT_EQ(run.loop.trip().reason, Reason::enable_failed);
  EXPECT_FALSE(run.rig.enabled());
  EXPECT_FALSE(run.rig.powered());
  EXPECT_TRUE(run.rig.watchdog_has_acted()) << "whether the stage is off is unknown";
}

// Point. A contact that is held by hand: an arming and a way back to rest last as long as it is held; a run does not ask
// for it.
TEST(LowEnergy, AHandHoldsArmingAndRest) {
  Scene scene = looked_at(RigKind::component_bench);
  scene.reference = road(9000, 1.0, 0.03);
  scene.settings.arming.hold_to_run = 2;                                   // interlock 1
  const std::array<OpenInterlock, 5> open{{{1, {ms * 0, ms * 100}},        // not held at first
                                           {1, {ms * 800, ms * 900}},      // let go in the probe
                                           {1, {ms * 5000, ms * 9500}},    // nobody holds it in the run
                                           {1, {ms * 9990, ms * 9995}},    // let go on the way to rest
                                           {0, {ms * 9000, ms * 9001}}}};  // the other one ends the run
  scene.faults.open_interlocks = open;
  Journey run{scene};
  run.periods(50);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
  run.loop.arm();
  run.periods(2);
  EXPECT_EQ(run.loop.trip().reason, Reason::interlock) << "not held: refused";
  EXPECT_EQ(run.loop.trip().interlock, 1);
  for (const Record& row : run.records) EXPECT_FALSE(row.enabled);
  until(run, 200);
  run.loop.acknowledge();
  run.periods(2);
  run.loop.arm();
  until(run, 799);
  ASSERT_EQ(run.loop.mode(), Mode::arming);
  EXPECT_TRUE(run.rig.enabled());
  run.periods(5);
  EXPECT_EQ(run.loop.mode(), Mode::safe) << "let go";
  EXPECT_FALSE(run.rig.enabled());
  until(run, 1000);
  run.loop.acknowledge();
  run.periods(2);
  run.loop.arm();
  until(run, 3000);
  ASSERT_EQ(run.loop.mode(), Mode::armed) << name(run.loop.trip().reason);
  run.loop.start();
  until(run, 8999);
  ASSERT_EQ(run.loop.mode(), Mode::running) << name(run.loop.trip().reason);
  until(run, 9300);
  EXPECT_EQ(run.loop.trip().reason, Reason::interlock);
  EXPECT_EQ(run.loop.trip().interlock, 0);
  ASSERT_GT(std::abs(run.rig.drive().position), 1e-3);
  run.loop.go_to_rest();
  run.periods(2);
  EXPECT_FALSE(run.rig.enabled()) << "not held: no rest";
  ASSERT_EQ(run.loop.rest_refusals().size(), 1U);
  EXPECT_EQ(run.loop.rest_refusals().at(0).interlock, 1);
  until(run, 9900);
  run.loop.go_to_rest();
  until(run, 9980);
  EXPECT_TRUE(run.rig.enabled()) << "held: on the way to rest at 0.05 m/s";
  EXPECT_EQ(run.loop.rest_refusals().size(), 0U);
  until(run, 10'010);
  EXPECT_FALSE(run.rig.enabled()) << "let go";
  EXPECT_TRUE(run.loop.held());
}

// Point. A stop channel that nobody has tried for so long may be dead: no power until somebody has pressed.
TEST(LowEnergy, TheStopButtonIsTried) {
  Scene scene = looked_at(RigKind::component_bench);
  scene.settings.arming.stop_test = 4.0;
  const Press press{{ms * 300, ms * 350}};
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  const auto arm = [&] {
    run.loop.acknowledge();
    run.periods(2);
    run.loop.arm();
    run.periods(10);
  };
  run.periods(10);
  arm();
  EXPECT_EQ(run.loop.trip().reason, Reason::arming_stop_untested);
  EXPECT_EQ(run.loop.refusals().size(), 1U);
  for (const Record& row : run.records) EXPECT_FALSE(row.enabled);
  until(run, 400);
  arm();
  EXPECT_EQ(run.loop.mode(), Mode::arming);
  run.loop.stop();
  until(run, 4500);
  arm();
  EXPECT_EQ(run.loop.trip().reason, Reason::arming_stop_untested);
  EXPECT_NEAR(run.loop.trip().value, 4.2, 0.02) << "from the press on, not from its acknowledge";
}

// Fault. One contact of the button is welded: the other one stops the rig at once, and has not tested it.
TEST(LowEnergy, OneContactIsNoTestOfTheStopButton) {
  Scene scene = looked_at(RigKind::component_bench);
  scene.settings.arming.stop_test = 3600.0;
  for (const auto contacts : {Press::Contacts::first, Press::Contacts::second, Press::Contacts::both}) {
    const Press press{{ms * 100, ms * 200}, contacts};
    scene.faults.presses = {&press, 1};
    Journey run{scene};
    until(run, 150);
    EXPECT_EQ(run.loop.trip().reason, Reason::stop_button);
    until(run, 300);
    run.loop.acknowledge();
    run.periods(2);
    run.loop.arm();
    run.periods(10);
    if (contacts == Press::Contacts::both) {
      EXPECT_EQ(run.loop.mode(), Mode::arming);
    } else {
      EXPECT_EQ(run.loop.trip().reason, Reason::arming_stop_untested);
      EXPECT_FALSE(run.rig.enabled());
    }
  }
}

/// Where a drive that runs away at this speed from a command that stands is noticed [m].
double runaway(double speed, bool slow, int calm, Reason& reason) {
  hal::SensorSetup setup;
  setup[model::index(Channel::x_act)].fitted = true;
  SilentSensors sensors(setup);
  firmware::Settings settings;
  settings.limits.following_least = 0.0;
  firmware::SampleGuard samples(settings.limits, settings.period, sensors);
  firmware::MotionGuard guard(settings.limits, settings.supervision, paper_rig(RigKind::component_bench), h,
                              settings.highest_low_speed());
  guard.move_slowly(slow);
  double x = 0.0;
  for (int k = 0; k < 2000; ++k) {
    if (k >= calm) x += speed * h;
    hal::Frame frame;
    frame.channels[model::index(Channel::x_act)] = {x, hal::milliseconds(k), hal::Quality::good};
    samples.take(frame, hal::milliseconds(k));
    if (const auto trip = guard.follow({}, samples)) {
      reason = trip->reason;
      return x;
    }
  }
  return x;
}

// Point. A drive that runs away at 0.4 m/s while it arms is noticed by its speed, beyond the reduced one of 0.25 m/s:
// that the difference over 10 ms shows it takes 6.25 ms, its confirmation two samples more, 3.6 mm at most with the
// rounding to periods. In a run the error of 10 mm has to last for 50 ms (without following_least). A ramp beyond 0.2 m/s moves the limit with it.
TEST(LowEnergy, ASlowMotionIsSlow) {
  Reason reason = Reason::none;
  EXPECT_LE(runaway(0.4, true, 100, reason), 4e-3);
  EXPECT_EQ(reason, Reason::measured_speed);
  EXPECT_GT(runaway(0.4, false, 100, reason), 10e-3);
  EXPECT_EQ(reason, Reason::following_error);
  firmware::Settings settings;
  EXPECT_EQ(settings.highest_low_speed(), 0.25);
  settings.ramps.rate = 0.4;
  EXPECT_DOUBLE_EQ(settings.highest_low_speed(), 0.5);
  settings.limits.low_speed = 0.45;
  EXPECT_NE(settings.check(), "") << "a ramp that trips itself";
}

// Point. In the loop: a position that steps by 4 mm within a sample moves by 0.4 m/s over the guard's 10 ms. An armed rig
// trips by that, a run with its limit of 0.875 m/s does not.
TEST(LowEnergy, TheLoopKnowsWhichMotionsAreSlow) {
  for (const bool in_a_run : {false, true}) {
    const hal::simulated::ChannelFault step{.kind = hal::simulated::ChannelFault::Kind::spike,
                                            .channel = model::index(Channel::x_act),
                                            .window = {ms * 5000, ms * 5020},
                                            .spike = 4e-3};
    Scene scene = looked_at(RigKind::component_bench, 9000);
    scene.reference.assign(9000, Motion{});
    scene.faults.channels = {&step, 1};
    Journey run{scene};
    run.loop.arm();
    until(run, 3000);
    ASSERT_EQ(run.loop.mode(), Mode::armed) << name(run.loop.trip().reason);
    if (in_a_run) run.loop.start();
    until(run, 5030);
    EXPECT_EQ(run.loop.trip().reason, in_a_run ? Reason::none : Reason::measured_speed);
    if (!in_a_run) {
      EXPECT_EQ(run.loop.trip().limit, 0.25);
    }
  }
}

// Point. A drive that moves without power is said, whatever happened before: as the second reason, where another one
// already is.
TEST(LowEnergy, MotionWithoutPowerIsSaidInAnyCase) {
  Scene scene = looked_at(RigKind::component_bench);
  const std::array<Press, 2> presses{Press{{ms * 20, ms * 30}}, Press{{ms * 40, ms * 50}}};
  const std::array<OpenInterlock, 1> open{{{0, {ms * 20}}}};
  const hal::simulated::Push push{0.05, {ms * 1000}};
  scene.faults.presses = presses;
  scene.faults.open_interlocks = open;
  scene.faults.pushes = {&push, 1};
  Journey run{scene};
  run.periods(10);
  run.loop.arm();
  run.periods(900);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button);
  run.periods(600);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button) << "the first one stays";
  EXPECT_EQ(run.loop.second().reason, Reason::motion_without_power);
  EXPECT_EQ(run.records.back().second, Reason::motion_without_power);
}

// Fault. A rig that is in safe, then a press, which stays latched: what shows power that nobody gave is said beside it,
// and the watchdog takes the supply.
TEST(LowEnergy, ALatchedPressHidesNoMotionWithoutPower) {
  Scene scene = looked_at(RigKind::component_bench);
  const Press press{{ms * 40, ms * 42}};
  const hal::simulated::Push push{0.05, {ms * 1000}};
  scene.faults.presses = {&press, 1};
  scene.faults.pushes = {&push, 1};
  Journey run{scene};
  run.periods(10);
  run.loop.stop();
  run.periods(900);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_requested);
  EXPECT_EQ(run.loop.second().reason, Reason::stop_button);
  EXPECT_FALSE(run.rig.watchdog_has_acted());
  run.periods(400);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_requested) << "the first one stays";
  EXPECT_EQ(run.loop.second().reason, Reason::motion_without_power) << "it takes the place of any other";
  EXPECT_TRUE(run.rig.watchdog_has_acted());
}

// Fault. A drive without an enable, whose converter shows 30 mm and stands at 0: arming begins where the converter says,
// and the first command would have been a jump of 30 mm. Nothing is written before the comparison, nor after it failed.
TEST(LowEnergy, ALyingConverterMovesNoDriveThatHasPower) {
  const hal::simulated::ReadBackError error{0.03};
  Scene scene = looked_at(RigKind::component_bench);
  scene.drive_enable = false;
  scene.faults.read_back_errors = {&error, 1};
  Journey run{scene};
  run.periods(50);
  run.loop.arm();
  for (int k = 0; k < 3000; ++k) {
    run.periods(1);
    ASSERT_EQ(run.rig.drive().position, 0.0) << k;
  }
  EXPECT_EQ(run.loop.trip().reason, Reason::arming_position);
  run.loop.acknowledge();
  run.periods(2);
  run.loop.arm();
  run.periods(10);
  EXPECT_EQ(run.rig.drive().position, 0.0) << "nor at the second try";
}

}  // namespace
}  // namespace low_energy_test
