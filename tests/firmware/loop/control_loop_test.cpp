#include "firmware/loop/control_loop.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

#include "tests/firmware/loop/rig_under_test.hpp"
#include "tests/support/without_heap.hpp"

namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using firmware::ValvePlan;
using hal::Openings;
using model::CoreIndex;
using model::RigKind;

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

// Journey. One run of each kind from idle to its orderly end: every sample of the reference is a row of the run, no
// more and no less, nothing trips, nothing is lost, and the rig ends at rest.
TEST(ControlLoop, RunsAReferenceFromEndToEnd) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    Journey run{Scene(kind, 1000)};
    run.periods(3);
    EXPECT_EQ(run.loop.mode(), Mode::idle) << "nobody has asked for a run";
    EXPECT_EQ(run.rig.openings(), Openings::first(6));
    run.whole();
    EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << name(run.loop.trip().reason);
    const auto rows = run.rows(Mode::running);
    ASSERT_EQ(rows.size(), 1000U) << name(kind);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      ASSERT_EQ(rows[k].sample, k);
      ASSERT_EQ(rows[k].time, ms * static_cast<std::int64_t>(k + 3));
      ASSERT_EQ(rows[k].openings, Openings::first(k == 999 ? 6 : 2)) << "safe once the reference has ended";
    }
    for (std::size_t k = 0; k < run.records.size(); ++k)
      ASSERT_EQ(run.records[k].period, k) << "a journal without gaps";
    EXPECT_EQ(run.loop.counters(), firmware::Counters{}) << name(kind);
    EXPECT_EQ(run.journal.lost(), 0U);
    EXPECT_EQ(run.loop.mode(), Mode::safe);
    EXPECT_EQ(run.rig.command(), hal::Command{});
    EXPECT_EQ(run.rig.openings(), Openings::first(6));
  }
}

// Timing. Row k of a rig that follows at once shows the reference at t_k: the command for it went out one period
// before.
TEST(ControlLoop, CommandsWhatIsDueOnePeriodLater) {
  Journey car{Scene(RigKind::quarter_car)};
  car.whole();
  const auto rows = car.rows(Mode::running);
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    ASSERT_EQ(value(rows[k], Channel::z_r), car.scene.reference[k].position) << k;
    ASSERT_EQ(rows[k].command.position, car.scene.reference[k + 1].position) << k;
    ASSERT_EQ(rows[k].command.velocity, car.scene.reference[k + 1].velocity) << k;
    ASSERT_EQ(rows[k].command.acceleration, car.scene.reference[k + 1].acceleration) << k;
  }
  Journey bench{Scene(RigKind::component_bench)};
  bench.whole();
  for (const Record& row : bench.rows(Mode::running)) {
    ASSERT_EQ(value(row, Channel::x_cmd), bench.scene.reference[row.sample].position);
    ASSERT_EQ(value(row, Channel::x_act), bench.scene.reference[row.sample].position);
  }
}

// One model. Loop, virtual car and machine, joined through hal, are the same numbers as the whole rig in one step
// function: bit for bit, with delay, quadratic losses and ducts that switch.
TEST(ControlLoop, ClosesTheHilLoopToTheBitsOfTheModel) {
  Scene scene(RigKind::hil, 2000);
  scene.parameters.effects.add<model::ActuatorDelay>({0.010});
  const std::array<ValvePlan::Change, 2> changes{
      {{ms * 500, Openings::first(3)}, {ms * 900, Openings::from_bits(0b110)}}};
  scene.valves = ValvePlan(Openings::first(2), changes);
  Journey run{scene};
  run.whole();
  const auto rows = run.rows(Mode::running);
  ASSERT_EQ(rows.size(), 2000U);

  const model::RigModel<double> whole(scene.parameters, h);
  auto state = whole.start(scene.reference[0].position);
  state.foot_point = scene.reference[0];
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto s = whole.signals(state);
    for (const Channel c : {Channel::z_r, Channel::z_w, Channel::z_b, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b,
                            Channel::dz_w, Channel::dz_b, Channel::F_w, Channel::x_cmd, Channel::x_act, Channel::F}) {
      ASSERT_EQ(bits(value(rows[k], c)), bits(s[model::index(c)])) << name(c) << " at " << k;
    }
    ASSERT_EQ(rows[k].velocities.wheel, state.core(CoreIndex::wheel_velocity)) << k;
    ASSERT_EQ(rows[k].velocities.body, state.core(CoreIndex::body_velocity)) << k;
    if (k == 500) whole.open_ducts(state, 0b111);
    if (k == 900) whole.open_ducts(state, 0b110);
    if (k + 1 < rows.size()) whole.step(state, {.foot_point = scene.reference[k + 1]});
  }
}

// The feed-forward of the hil command: velocity and acceleration are derivatives of the position that goes out. Central
// differences of 1 ms against 13 Hz and below: (2πf h)²/6 = 0.1 % of the largest value; F, held for a period, jumps the
// acceleration by up to its change within a period, some 3 %.
TEST(ControlLoop, FeedsForwardWhatTheDeflectionDoes) {
  Journey run{Scene(RigKind::hil, 2000)};
  run.whole();
  const auto rows = run.rows(Mode::running);
  double fastest = 0.0, sharpest = 0.0, velocity_error = 0.0, acceleration_error = 0.0;
  for (std::size_t k = 1; k + 2 < rows.size(); ++k) {
    const double before = rows[k - 1].command.position, now = rows[k].command.position,
                 after = rows[k + 1].command.position;
    fastest = std::max(fastest, std::abs(rows[k].command.velocity));
    sharpest = std::max(sharpest, std::abs(rows[k].command.acceleration));
    velocity_error = std::max(velocity_error, std::abs(rows[k].command.velocity - (after - before) / (2.0 * h)));
    acceleration_error =
        std::max(acceleration_error, std::abs(rows[k].command.acceleration - (after - 2.0 * now + before) / (h * h)));
  }
  EXPECT_GT(fastest, 0.01);
  EXPECT_LT(velocity_error, 0.002 * fastest);
  EXPECT_LT(acceleration_error, 0.06 * sharpest);
}

// Ready. A reference that begins elsewhere is approached smoothly, waited at, and only then followed; the valves
// already stand as the run begins.
TEST(ControlLoop, MovesSmoothlyToWhereTheReferenceBegins) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::component_bench}) {
    Scene scene(kind, 500);
    scene.reference = road(500, 1.0, 0.03);
    scene.settings.ramps.rest = -0.01;
    scene.settings.ramps.settling = 0.1;
    Journey run{scene};
    run.periods(2);
    run.whole();
    for (const Record& row : run.rows(Mode::idle)) EXPECT_EQ(row.command, (hal::Command{-0.01, 0.0, 0.0}));
    const auto ready = run.rows(Mode::ready);
    EXPECT_EQ(ready.size(), 1200U + 100U) << "1.5 · 40 mm / 0.05 m/s, then 0.1 s";
    double last = -0.01;
    for (const Record& row : ready) {
      EXPECT_LE(std::abs(row.command.position - last) / h, 0.05 * (1.0 + 1e-9));
      EXPECT_EQ(row.openings, Openings::first(2));
      last = row.command.position;
    }
    EXPECT_EQ(last, 0.03);
    const auto rows = run.rows(Mode::running);
    ASSERT_EQ(rows.size(), 500U);
    EXPECT_EQ(value(rows[0], kind == RigKind::quarter_car ? Channel::z_r : Channel::x_act), 0.03);
    EXPECT_EQ(run.rig.command().position, -0.01) << "back at rest in the end";
  }
}

// In hil the machine has nowhere to go: the virtual car waits above the beginning of its road, undeflected.
TEST(ControlLoop, LetsTheVirtualCarWaitAboveItsRoad) {
  Scene scene(RigKind::hil, 300);
  scene.reference = road(300, 1.0, 0.5);
  scene.settings.ramps.settling = 0.05;
  Journey run{scene};
  run.whole();
  const auto ready = run.rows(Mode::ready);
  EXPECT_EQ(ready.size(), 50U);
  for (const Record& row : ready) {
    EXPECT_EQ(row.command, hal::Command{});
    EXPECT_EQ(value(row, Channel::z_b), 0.5);
    EXPECT_EQ(value(row, Channel::dz_b), 0.0);
  }
  EXPECT_EQ(run.rows(Mode::running).size(), 300U);
}

// Valves switch at exactly the sample whose time the table names; the plant feels them from that sample on.
TEST(ControlLoop, SwitchesValvesAtTheVerySample) {
  Scene scene(RigKind::hil, 400);
  const std::array<ValvePlan::Change, 3> changes{
      {{ms * 100, Openings::first(1)}, {ms * 101, Openings{}}, {ms * 250 - hal::nanoseconds(1), Openings::first(5)}}};
  scene.valves = ValvePlan(Openings::first(2), changes);
  Journey run{scene};
  run.whole();
  for (const Record& row : run.rows(Mode::running)) {
    if (row.sample == 399) break;  // safe from here
    const Openings expected = row.sample < 100   ? Openings::first(2)
                              : row.sample < 101 ? Openings::first(1)
                              : row.sample < 250 ? Openings{}
                                                 : Openings::first(5);
    ASSERT_EQ(row.openings, expected) << row.sample;
  }
}

// quarter_car: the estimated velocities are those of the model behind the sensors. Bound: straight lines between
// samples, (2πf h)²/12 of the 13 Hz part (0.6e-3), and of what else the wheel does; relative to each largest value.
TEST(ControlLoop, EstimatesTheVelocitiesOfTheRig) {
  Scene scene(RigKind::quarter_car, 4000);
  Journey run{scene};
  run.loop.arm();
  run.loop.start();
  double worst_wheel = 0.0, worst_body = 0.0, worst_foot = 0.0, wheel = 0.0, body = 0.0, foot = 0.0, worst_load = 0.0;
  for (int k = 0; k < 3990; ++k) {
    run.periods(1);
    const auto& v = run.loop.estimator().velocities();
    const auto& x = run.plant.state();
    ASSERT_TRUE(std::isfinite(v.foot_point + v.wheel + v.body + run.loop.estimator().wheel_load())) << k;
    worst_foot = std::max(worst_foot, std::abs(v.foot_point - x.foot_point.velocity));
    worst_wheel = std::max(worst_wheel, std::abs(v.wheel - x.core(CoreIndex::wheel_velocity)));
    worst_body = std::max(worst_body, std::abs(v.body - x.core(CoreIndex::body_velocity)));
    foot = std::max(foot, std::abs(x.foot_point.velocity));
    wheel = std::max(wheel, std::abs(x.core(CoreIndex::wheel_velocity)));
    body = std::max(body, std::abs(x.core(CoreIndex::body_velocity)));
    EXPECT_EQ(v.deflection, v.wheel - v.body);
    worst_load = std::max(worst_load, std::abs(run.loop.estimator().wheel_load() -
                                               200e3 * (x.foot_point.position - x.core(CoreIndex::wheel_position))));
  }
  EXPECT_GT(wheel, 0.03);
  EXPECT_LT(worst_foot, 1e-3 * foot);
  EXPECT_LT(worst_wheel, 1e-3 * wheel);
  EXPECT_LT(worst_body, 1e-3 * body);
  EXPECT_LT(worst_load, 1e-9) << "k_t dz_w, rounding of 1000 N";
}

// No heap after start: not in the loop, not in the model below it, in any state of any kind.
TEST(ControlLoop, TakesNoHeapAfterStart) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    Scene scene(kind, 200);
    scene.journal = 8;  // and overflows: that, too, without heap
    scene.settings.ramps.settling = 0.02;
    Journey run{scene};
    const std::uint64_t lost = support::without_heap([&] {
      run.loop.arm();
      run.loop.start();
      for (int k = 0; k < 1000; ++k) {
        run.rig.roles().clock.sleep_until(run.loop.due());
        run.loop.step();
        if (k == 800) run.loop.acknowledge();
      }
      return run.journal.lost();
    });
    EXPECT_EQ(lost, 1000U - 8U) << name(kind);
    EXPECT_EQ(run.loop.mode(), Mode::idle);
  }
}

// After safe: an acknowledgement, a fresh start, and the second run is the first one again, to the bit.
TEST(ControlLoop, RunsAgainAfterAFreshStart) {
  Scene scene(RigKind::component_bench, 300);
  const std::array<ValvePlan::Change, 1> change{{{ms * 100, Openings::first(3)}}};
  scene.valves = ValvePlan(Openings::first(2), change);
  Journey run{scene};
  run.whole();
  const auto first = run.rows(Mode::running);
  run.loop.arm();
  run.loop.start();
  run.periods(5);
  EXPECT_EQ(run.loop.mode(), Mode::safe) << "start alone does not leave safe";
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << "kept until the next start";
  run.records.clear();
  run.whole();
  const auto second = run.rows(Mode::running);
  ASSERT_EQ(second.size(), first.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    ASSERT_EQ(bits(second[k].command.position), bits(first[k].command.position));
    ASSERT_EQ(second[k].openings, first[k].openings);
    ASSERT_EQ(second[k].trip.reason, first[k].trip.reason) << "the first run's end is not the second's";
  }
}

TEST(ControlLoop, DoesNotAcknowledgeBeforeItIsAtRest) {
  Journey run{Scene(RigKind::component_bench, 1000)};
  run.loop.arm();
  run.loop.start();
  run.periods(300);
  run.loop.stop();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_requested);
  EXPECT_FALSE(run.loop.at_rest());
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::safe);
  run.periods(2000);
  EXPECT_TRUE(run.loop.at_rest());
  run.loop.acknowledge();
  run.periods(1);
  EXPECT_EQ(run.loop.mode(), Mode::idle);
}

TEST(ControlLoop, EndsARunWithoutReferenceAtOnce) {
  Scene scene(RigKind::quarter_car, 0);
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended);
  EXPECT_TRUE(run.rows(Mode::running).empty());
  EXPECT_EQ(run.rig.command(), hal::Command{});
}

// The journal says what was there and what was not: a number that nobody measured or computed is none.
TEST(ControlLoop, WritesNoNumberThatNobodyHas) {
  Journey bench{Scene(RigKind::component_bench, 10)};
  bench.whole();
  const Record row = bench.rows(Mode::running).front();
  EXPECT_TRUE(std::isnan(value(row, Channel::z_r)));
  EXPECT_TRUE(std::isnan(value(row, Channel::F_w)));
  EXPECT_TRUE(std::isnan(row.wheel_load));
  EXPECT_TRUE(std::isnan(row.velocities.wheel));
  EXPECT_FALSE(std::isnan(row.velocities.deflection)) << "x_act, differentiated";
  EXPECT_EQ(row.taken[model::index(Channel::F)], row.time);
  EXPECT_EQ(row.taken[model::index(Channel::F_w)], hal::never);

  Journey car{Scene(RigKind::quarter_car, 10)};
  car.whole();
  EXPECT_TRUE(std::isnan(value(car.rows(Mode::running).front(), Channel::x_cmd)));
  EXPECT_TRUE(std::isnan(value(car.rows(Mode::running).front(), Channel::z_w)));

  Scene blind(RigKind::hil, 10);
  blind.sensors[model::index(Channel::x_act)].fitted = false;
  Journey hil{blind};
  hil.whole();
  EXPECT_TRUE(std::isnan(value(hil.rows(Mode::running).front(), Channel::x_act)));
  EXPECT_TRUE(std::isnan(value(hil.rows(Mode::running).front(), Channel::F_act)));
  EXPECT_TRUE(std::isnan(value(hil.rows(Mode::safe).back(), Channel::z_w))) << "the car is not computed in safe";
}

TEST(ControlLoop, SaysWhichPartsDoNotFit) {
  Journey run{Scene(RigKind::hil)};
  const auto check = [&](const auto& spoil) {
    Scene scene(RigKind::hil);
    spoil(scene);
    ModelPlant plant(paper_rig(RigKind::hil), 0.0);
    hal::simulated::Construction c;
    c.period = ms;
    c.sensors = scene.sensors;
    c.ducts = 2;
    hal::simulated::Rig rig(plant, c);
    return firmware::ControlLoop::check(scene.settings, scene.parameters, rig.roles(), scene.valves);
  };
  EXPECT_EQ(check([](Scene&) {}), "");
  EXPECT_EQ(check([](Scene& s) { s.settings.limits.force = -1.0; }).substr(0, 12), "limits.force");
  EXPECT_EQ(check([](Scene& s) { s.parameters.body.mass = -1.0; }).substr(0, 10), "parameters");
  EXPECT_EQ(check([](Scene& s) { s.sensors[model::index(Channel::F)].fitted = false; }).substr(0, 7), "sensors");
  EXPECT_EQ(check([](Scene& s) { s.valves = ValvePlan(Openings::first(3)); }).substr(0, 10), "valve plan");
}

TEST(ControlLoopDeathTest, StopsAtPartsThatDoNotFit) {
  Scene scene(RigKind::hil);
  scene.sensors[model::index(Channel::F)].fitted = false;
  EXPECT_DEATH(Journey{scene}, "");
}

}  // namespace
