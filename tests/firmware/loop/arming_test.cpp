// Arming: what is looked at before a drive may be led, on rigs that are not as described.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/firmware/loop/rig_under_test.hpp"

namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using hal::simulated::ReadBackError;
using model::RigKind;

constexpr firmware::Arming everything{.tare_time = 0.5,
                                      .preload = 2500.0,
                                      .sway = 250.0,
                                      .wander = 0.5e-3,
                                      .position_tolerance = 5e-3,
                                      .probe_amplitude = 2e-3,
                                      .force_ramp = 0.5};

Scene checked(RigKind kind, std::size_t samples = 1000) {
  Scene scene(kind, samples);
  scene.settings.arming = everything;
  scene.journal = 16;
  return scene;
}

/// Armed, or refused, within 20 s.
void arm(Journey& run) {
  run.periods(50);
  run.loop.arm();
  run.periods(1);
  for (int k = 0; k < 20'000 && run.loop.mode() == Mode::arming; ++k) run.periods(1);
}

// A sound rig of each kind is armed, waits for a start of its own, and runs to the end of its reference.
TEST(Arming, PassesASoundRig) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    Journey run{checked(kind)};
    arm(run);
    ASSERT_EQ(run.loop.mode(), Mode::armed) << name(kind) << ": " << name(run.loop.trip().reason);
    EXPECT_TRUE(run.rig.enabled());
    run.periods(2000);
    EXPECT_EQ(run.loop.mode(), Mode::armed) << "nobody has started it";
    run.loop.start();
    run.periods(6000);
    EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << name(kind);
  }
}

// A start during the checks is not kept for later: it is an action of its own, from armed.
TEST(Arming, StartsOnlyFromArmed) {
  Journey run{checked(RigKind::hil)};
  run.loop.start();
  run.periods(10);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
  run.loop.arm();
  run.periods(10);
  run.loop.start();
  run.periods(6000);
  EXPECT_EQ(run.loop.mode(), Mode::armed);
}

// A drive that stands 80 mm from rest is met where it stands. Bench and hil then return to rest at ramps.rate in
// arming, a quarter car moves to its road in ready: never by more than a period at that rate.
TEST(Arming, BeginsWhereTheDriveStands) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    Scene scene = checked(kind);
    scene.drive_at = 0.08;
    scene.settings.arming.off_centre = true;
    scene.deviations.force_offset = 300.0;
    if (kind == RigKind::hil) scene.deviations.force_sign = 1.0;
    Journey run{scene};
    run.periods(50);
    run.loop.arm();
    EXPECT_LE(largest_step(run, 6000), 0.05 * h * (1.0 + 1e-9)) << name(kind);
    ASSERT_EQ(run.loop.mode(), Mode::armed) << name(kind) << ": " << name(run.loop.trip().reason);
    EXPECT_NEAR(run.rig.drive().position, kind == RigKind::quarter_car ? 0.08 : 0.0, 1e-6) << name(kind);
    run.loop.start();
    EXPECT_LE(largest_step(run, 6500), 0.7 * h);
    EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << name(kind);
  }
}

// Without an enable the drive has power all the time: the command begins where the converter shows it.
TEST(Arming, WithoutEnableBeginsWhereTheConverterStands) {
  Scene scene = checked(RigKind::component_bench);
  scene.drive_enable = false;
  scene.drive_at = 0.08;
  Journey run{scene};
  run.periods(50);
  EXPECT_EQ(run.rig.drive().position, 0.08) << "idle writes nothing to a drive that has power";
  run.loop.arm();
  EXPECT_LE(largest_step(run, 5000), 0.05 * h * (1.0 + 1e-9));
  EXPECT_EQ(run.loop.mode(), Mode::armed) << name(run.loop.trip().reason);
}

struct Refusal {
  std::string what;
  Scene scene;
  Reason reason;
};

// Fault. Rigs that are not as described are refused, for the reason that is true, without power afterwards, and without
// ever having moved further than twice the probe and the tolerance.
TEST(Arming, RefusesARigThatIsNotAsDescribed) {
  std::vector<Refusal> refusals;
  const auto refuse = [&](std::string what, RigKind kind, Reason reason, const auto& spoil) {
    Scene scene = checked(kind);
    spoil(scene);
    refusals.push_back({std::move(what), scene, reason});
  };
  refuse("F has the wrong sign", RigKind::hil, Reason::arming_polarity_F,
         [](Scene& s) { s.deviations.force_sign = -1.0; });
  refuse("F in kilonewtons", RigKind::hil, Reason::arming_polarity_F, [](Scene& s) { s.deviations.force_sign = 1e-3; });
  refuse("F hardly answers", RigKind::hil, Reason::arming_polarity_F, [](Scene& s) { s.deviations.force_sign = 0.01; });
  refuse("F ten times too large", RigKind::hil, Reason::arming_polarity_F,
         [](Scene& s) { s.deviations.force_sign = 10.0; });
  refuse("x_act has the wrong sign", RigKind::hil, Reason::arming_polarity_x_act,
         [](Scene& s) { s.deviations.position_sign = -1.0; });
  refuse("x_act has the wrong sign", RigKind::component_bench, Reason::arming_polarity_x_act,
         [](Scene& s) { s.deviations.position_sign = -1.0; });
  refuse("x_act hardly follows", RigKind::component_bench, Reason::arming_polarity_x_act,
         [](Scene& s) { s.deviations.position_sign = 0.01; });
  refuse("x_act twice too large", RigKind::component_bench, Reason::arming_polarity_x_act,
         [](Scene& s) { s.deviations.position_sign = 2.0; });
  refuse("a preload of 2845 N", RigKind::hil, Reason::arming_preload,
         [](Scene& s) { s.deviations.force_offset = 2845.0; });
  refuse("a force that swings by 3 kN at rest", RigKind::hil, Reason::arming_not_at_rest,
         [](Scene& s) { s.deviations.force_noise = 3000.0; });
  refuse("a force that sways by 95 N, as of somebody on the rig", RigKind::quarter_car, Reason::arming_not_at_rest,
         [](Scene& s) {
           s.settings.arming.sway = 90.0;
           s.deviations.force_noise = 95.0;
         });
  refuse("a quarter car with 5 kN on its wheel", RigKind::quarter_car, Reason::arming_preload,
         [](Scene& s) { s.deviations.force_offset = 5000.0; });
  refuse("z_r has the wrong sign", RigKind::quarter_car, Reason::arming_polarity_x_act,
         [](Scene& s) { s.deviations.position_sign = -1.0; });
  refuse("noise that hides the sign", RigKind::hil, Reason::arming_noise, [](Scene& s) {
    s.settings.arming.preload = 5000.0;
    s.settings.arming.sway = 5000.0;
    s.settings.arming.probe_amplitude = 0.2e-3;
    s.deviations.force_noise = 2400.0;
  });
  refuse("a drive with power that stands elsewhere", RigKind::component_bench, Reason::arming_position, [](Scene& s) {
    s.drive_enable = false;
    s.deviations.position_offset = 0.08;
  });
  refuse("a quarter car that stands elsewhere", RigKind::quarter_car, Reason::arming_position, [](Scene& s) {
    s.drive_enable = false;
    s.deviations.position_offset = -0.08;
  });
  for (const Refusal& refusal : refusals) {
    Journey run{refusal.scene};
    run.periods(50);
    run.loop.arm();
    const double from = run.rig.drive().position;
    double farthest = 0.0;
    for (int k = 0; k < 5000; ++k) {
      run.periods(1);
      farthest = std::max(farthest, std::abs(run.rig.drive().position - from));
    }
    EXPECT_EQ(run.loop.trip().reason, refusal.reason) << refusal.what << ": " << name(run.loop.trip().reason);
    EXPECT_EQ(run.loop.mode(), Mode::safe) << refusal.what;
    EXPECT_FALSE(run.rig.enabled() && refusal.scene.drive_enable) << refusal.what;
    EXPECT_LE(farthest, 2.0 * 2e-3 + 5e-3) << refusal.what;
  }
}

// Fault. x_act has the wrong sign and the drive stands 60 mm off the middle: no power, since the command would throw it
// to the other side. Once a probe has shown the sign the next arming may begin anywhere.
TEST(Arming, GivesNoPowerOffTheMiddleBeforeTheSignIsKnown) {
  for (const double sign : {-1.0, 1.0}) {
    Scene scene = checked(RigKind::component_bench);
    scene.drive_at = 0.06;
    scene.deviations.position_sign = sign;
    Journey run{scene};
    arm(run);
    EXPECT_EQ(run.loop.trip().reason, Reason::arming_off_centre);
    EXPECT_EQ(run.rig.drive().position, 0.06);
    for (const Record& row : run.records) EXPECT_FALSE(row.enabled);
  }
  Scene scene = checked(RigKind::quarter_car);
  scene.reference = road(9000, 1.0, 0.03);
  const hal::simulated::Press press{{ms * 6000, ms * 6010}};
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  arm(run);
  run.loop.start();
  run.periods(static_cast<std::size_t>(6300 - run.rig.now().ns / 1'000'000));
  ASSERT_EQ(run.loop.trip().reason, Reason::stop_button);
  ASSERT_GT(std::abs(run.rig.drive().position), 0.01);
  run.loop.acknowledge();
  run.periods(1);
  arm(run);
  EXPECT_EQ(run.loop.mode(), Mode::armed) << name(run.loop.trip().reason);
}

// Fault. A converter that shows something else than it was told: power never comes on.
TEST(Arming, RefusesAConverterThatDoesNotShowTheCommand) {
  const ReadBackError error{0.01};
  Scene scene = checked(RigKind::component_bench);
  scene.faults.read_back_errors = {&error, 1};
  Journey run{scene};
  arm(run);
  EXPECT_EQ(run.loop.trip().reason, Reason::arming_read_back);
  EXPECT_NEAR(run.loop.trip().value, 0.01, 1e-9);
  for (const Record& row : run.records) EXPECT_FALSE(row.enabled);
}

std::vector<Reason> refused(const Journey& run) {
  std::vector<Reason> reasons;
  for (std::size_t i = 0; i < run.loop.refusals().size(); ++i) reasons.push_back(run.loop.refusals().at(i).reason);
  return reasons;
}

// Point. Somebody who stands before a rig that is not armed learns all that is wrong at once: button pressed, both
// interlocks open, the drive off the middle. Nothing has moved or had power for it.
TEST(Arming, ListsAllThatIsWrongBeforePower) {
  const hal::simulated::Press press{{ms * 50, ms * 5000}};  // in the very period of the arming: before, idle ends by it
  const std::array<hal::simulated::OpenInterlock, 2> open{{{0, {ms * 40, ms * 5000}}, {1, {ms * 40, ms * 5000}}}};
  Scene scene = checked(RigKind::component_bench);
  scene.drive_at = 0.06;
  scene.faults.presses = {&press, 1};
  scene.faults.open_interlocks = open;
  Journey run{scene};
  arm(run);
  EXPECT_EQ(refused(run),
            (std::vector{Reason::stop_button, Reason::interlock, Reason::interlock, Reason::arming_off_centre}));
  EXPECT_EQ(run.loop.refusals().at(1).interlock, 0);
  EXPECT_EQ(run.loop.refusals().at(2).interlock, 1);
  EXPECT_NEAR(run.loop.refusals().at(3).value, 0.06, 1e-8) << "seven digits";
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_button) << "the first one is the reason";
  EXPECT_EQ(run.rig.drive().position, 0.06);
  for (const Record& row : run.records) EXPECT_FALSE(row.enabled);
}

// The list of a probe: position and force each in their own words, the force against the command where the position
// is not to be believed. A sensor of x_act in the wrong unit alone says nothing about F.
TEST(Arming, ListsAllThatAProbeShows) {
  Scene scene = checked(RigKind::hil);
  scene.deviations.position_sign = 2.0;
  Journey one{scene};
  arm(one);
  EXPECT_EQ(refused(one), (std::vector{Reason::arming_polarity_x_act}));
  scene.deviations.force_sign = -1.0;
  Journey both{scene};
  arm(both);
  EXPECT_EQ(refused(both), (std::vector{Reason::arming_polarity_x_act, Reason::arming_polarity_F}));
  EXPECT_LT(both.loop.refusals().at(1).value, 0.0);
}

// A stop that is asked for is no failed check, and the next arming begins an empty list.
TEST(Arming, ListsNothingWhereNothingIsWrong) {
  const hal::simulated::Press press{{ms * 60, ms * 70}};
  Scene scene = checked(RigKind::hil);
  scene.faults.presses = {&press, 1};
  Journey run{scene};
  arm(run);
  EXPECT_EQ(refused(run), (std::vector{Reason::stop_button}));
  run.periods(20);
  run.loop.acknowledge();
  run.periods(2);
  run.loop.arm();
  run.periods(10);
  EXPECT_EQ(run.loop.mode(), Mode::arming);
  EXPECT_TRUE(refused(run).empty());
  run.loop.stop();
  run.periods(10);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_requested);
  EXPECT_TRUE(refused(run).empty());
}

// Fault. A force that is read 2.9 times too large passes for a component of the described size, and the loop bears a
// factor of 1.21. What the component should answer is what it answered before. Without a proof (allowed_gain 0) nobody
// knows better.
TEST(Arming, RefusesAForceThatTheLoopDoesNotBear) {
  Journey before{checked(RigKind::hil)};
  arm(before);
  double products = 0.0, squares = 0.0;
  for (const Record& row : before.rows(Mode::arming)) {
    products += value(row, Channel::x_act) * value(row, Channel::F);
    squares += value(row, Channel::x_act) * value(row, Channel::x_act);
  }
  for (const double allowed : {1.21, 0.0}) {
    for (const double factor : {1.0, 2.9}) {
      Scene scene = checked(RigKind::hil);
      scene.settings.arming.probe_stiffness = products / squares;
      scene.settings.arming.allowed_gain = allowed;
      scene.deviations.force_sign = factor;
      Journey run{scene};
      arm(run);
      const bool passes = factor == 1.0 || allowed == 0.0;
      EXPECT_EQ(run.loop.mode(), passes ? Mode::armed : Mode::safe) << factor << ": " << name(run.loop.trip().reason);
      EXPECT_EQ(run.loop.trip().reason, passes ? Reason::none : Reason::arming_gain_F);
    }
  }
}

// Fault. The converter shows 20 mm, and answers too late in the very periods of the comparison: that is no agreement. No
// power until it has answered; one that shows what it was told is armed then.
TEST(Arming, ComparesWithAConverterThatAnswersLate) {
  const hal::simulated::DeviceFault late{
      hal::simulated::DeviceFault::Device::command, hal::Fault::timeout, {ms * 50, ms * 52}};
  const hal::simulated::ReadBackError error{0.02, {hal::Time{}}};
  for (const bool lies : {true, false}) {
    Scene scene = checked(RigKind::component_bench);
    scene.faults.devices = {&late, 1};
    if (lies) scene.faults.read_back_errors = {&error, 1};
    Journey run{scene};
    run.periods(50);
    run.loop.arm();
    run.periods(2);
    EXPECT_FALSE(run.rig.enabled()) << "not yet compared";
    run.periods(1500);
    EXPECT_EQ(run.rig.enabled(), !lies);
    EXPECT_EQ(run.loop.trip().reason, lies ? Reason::arming_read_back : Reason::none);
  }
}

// Fault. The position moves by 0.8 mm while it should rest: within the tolerance of the place, beyond `wander`.
TEST(Arming, RefusesADriveThatWanders) {
  const hal::simulated::ChannelFault nudge{.kind = hal::simulated::ChannelFault::Kind::spike,
                                           .channel = model::index(Channel::x_act),
                                           .window = {ms * 60, ms * 70},
                                           .spike = 0.8e-3};
  Scene scene = checked(RigKind::component_bench);
  scene.faults.channels = {&nudge, 1};
  Journey run{scene};
  arm(run);
  EXPECT_EQ(run.loop.trip().reason, Reason::arming_not_at_rest) << name(run.loop.trip().reason);
  EXPECT_EQ(run.loop.trip().channel, Channel::x_act);
  EXPECT_NEAR(run.loop.trip().value, 0.8e-3, 1e-9);
}

// A stop during arming acts as in any other state.
TEST(Arming, EndsAtAPress) {
  for (const int period : {60, 400, 800, 1200, 2500}) {
    const hal::simulated::Press press{{ms * period, ms * (period + 1)}};
    Scene scene = checked(RigKind::hil);
    scene.drive_at = 0.05;
    scene.settings.arming.off_centre = true;
    scene.faults.presses = {&press, 1};
    Journey run{scene};
    run.periods(50);
    run.loop.arm();
    run.periods(static_cast<std::size_t>(period) - 50);
    ASSERT_EQ(run.loop.mode(), Mode::arming) << period;
    const double there = run.rig.drive().position;
    run.periods(500);
    EXPECT_EQ(run.loop.trip().reason, Reason::stop_button) << period;
    EXPECT_NEAR(run.rig.drive().position, there, 0.15e-3) << period;
    EXPECT_FALSE(run.rig.enabled());
  }
}

// A described damper without a spring: the sign of its force is that against the velocity.
TEST(Arming, TellsTheSignOfADamper) {
  for (const double sign : {1.0, -1.0}) {
    Scene scene = checked(RigKind::hil, 200);
    scene.parameters.has_fdva = false;
    scene.valves = firmware::ValvePlan();
    scene.safe_position = {};
    scene.parameters.suspension.stiffness = 0.0;
    scene.parameters.suspension.damping = 3000.0;
    scene.deviations.force_sign = sign;
    Journey run{scene};
    arm(run);
    EXPECT_EQ(run.loop.mode(), sign > 0.0 ? Mode::armed : Mode::safe) << name(run.loop.trip().reason);
    EXPECT_EQ(run.loop.trip().reason, sign < 0.0 ? Reason::arming_polarity_F : Reason::none);
  }
}

// The offset of the force sensor is taken from what enters the car, and stays in what is recorded. An untared offset of
// 1000 N would move the car by 1000 N / (31.5 kN/m) and more.
TEST(Arming, TaresTheForceOfTheCar) {
  Scene scene = checked(RigKind::hil, 3000);
  scene.reference.assign(3000, Motion{});
  scene.deviations.force_offset = 1000.0;
  Journey run{scene};
  arm(run);
  ASSERT_EQ(run.loop.mode(), Mode::armed) << name(run.loop.trip().reason);
  EXPECT_NEAR(run.loop.tare(), 1000.0, 0.01) << "the oil still moves a little after the probe";
  run.loop.start();
  run.periods(2000);
  EXPECT_NEAR(run.rig.command().position, 0.0, 1e-6) << "0.01 N over 31.5 kN/m";
  EXPECT_NEAR(value(run.records.back(), Channel::F), 1000.0, 0.01) << "as it was read";
  EXPECT_EQ(run.records.back().tare, run.loop.tare());
}

// The force enters the car by a ramp from the beginning of a run: nothing at first, all of it after force_ramp.
TEST(Arming, LetsTheForceInByARamp) {
  for (const double ramp : {0.0, 0.5}) {
    Scene scene = checked(RigKind::hil, 2000);
    scene.settings.arming.force_ramp = ramp;
    scene.reference.assign(2000, Motion{});
    const hal::simulated::ChannelFault push{.kind = hal::simulated::ChannelFault::Kind::spike,
                                            .channel = model::index(Channel::F),
                                            .window = {ms * 6000},
                                            .spike = -500.0};
    scene.faults.channels = {&push, 1};
    Journey run{scene};
    arm(run);
    run.periods(static_cast<std::size_t>(6000 - run.rig.now().ns / 1'000'000) - 1);
    run.loop.start();
    run.periods(30);
    ASSERT_EQ(run.loop.mode(), Mode::running);
    const double moved = std::abs(run.rig.command().position);
    EXPECT_EQ(moved<1e-4, ramp> 0.0) << moved << " m: a ramp has let 1 % of 500 N in by then";
  }
}

// The energy guard follows the whole force from the rest before a run on: when it begins to judge, behind the ramp, it
// knows the motion that it begins in. It trips on nothing meanwhile, and on a wrong sign of the force soon behind it.
TEST(Arming, TheEnergyGuardKnowsTheMotionOfTheRamp) {
  for (const double sign : {1.0, -1.0}) {
    Scene scene = checked(RigKind::hil, 4000);
    scene.settings.arming.probe_amplitude = 0.0;  // which would find the sign
    scene.deviations.force_sign = sign;
    Journey run{scene};
    arm(run);
    run.loop.start();
    run.periods(4000);
    const std::vector<Record> rows = run.rows(Mode::running);
    ASSERT_GT(rows.size(), 500U);
    EXPECT_GT(rows[499].energy_taken, 0.0);
    EXPECT_NE(rows[499].energy_fed, 0.0);
    if (sign > 0.0) {
      EXPECT_FALSE(is_fault(run.loop.trip().reason)) << name(run.loop.trip().reason);
    } else {
      EXPECT_LT(rows.size(), 800U);
      EXPECT_EQ(run.loop.trip().reason, Reason::growth) << name(run.loop.trip().reason);
    }
  }
}

}  // namespace
