// A compensation between virtual car and machine, in the control loop around the model as the rig.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/loop/compensation/compensator.hpp"
#include "tests/firmware/loop/rig_under_test.hpp"
#include "tests/support/without_heap.hpp"

namespace compensated_loop_test {
namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using firmware::compensation::Compensator;
using firmware::compensation::Kind;

constexpr double late = 0.010;  ///< of the machine [s]

/// The paper's hil rig; with its virtual damping the loop is stable with and without compensation.
Scene late_scene(std::size_t samples = 3000) {
  Scene scene(model::RigKind::hil, samples);
  scene.parameters.effects.add(model::ActuatorDelay<double>{late});
  scene.settings.limits.following = 0.050;
  scene.settings.limits.acceleration = 2000.0;
  return scene;
}

firmware::compensation::Settings assuming(Kind kind, double delay = late) {
  firmware::compensation::Settings settings;
  settings.kind = kind;
  settings.machine.delay = delay;
  settings.component = {
      .stiffness = 31.5e3, .damping = 0.0, .has_fdva = true, .fdva = paper_rig(model::RigKind::hil).fdva};
  settings.damping = 500.0;
  return settings;
}

/// A journey with a compensation, or without.
struct Ride {
  explicit Ride(const Scene& scene, const std::optional<firmware::compensation::Settings>& settings) : run(scene) {
    if (settings) run.loop.attach(compensator.emplace(*settings, h));
  }
  std::optional<Compensator> compensator{};
  Journey run;
};

/// rms of x_act less the car's deflection, in terms of the deflection's, over the run behind the first half second.
double tracking_error(const Journey& run) {
  double off = 0.0, all = 0.0;
  const auto rows = run.rows(Mode::running);
  for (std::size_t k = 500; k < rows.size(); ++k) {
    const double wanted = value(rows[k], Channel::z_w) - value(rows[k], Channel::z_b);
    const double error = value(rows[k], Channel::x_act) - wanted;
    off += error * error;
    all += wanted * wanted;
  }
  return std::sqrt(off / all);
}

// Journey. The machine is 10 ms late: the body of the car swings at 1 Hz and the wheel at 13 Hz, so x_act is a good
// part of the deflection off. Each method that leads the command makes most of that good; the others leave the command.
TEST(CompensatedControlLoop, MakesTheMachineFollowTheCar) {
  Ride plain(late_scene(), std::nullopt);
  plain.run.whole();
  ASSERT_EQ(plain.run.loop.trip().reason, Reason::reference_ended);
  const double before = tracking_error(plain.run);
  EXPECT_GT(before, 0.1);
  for (const Kind kind : {Kind::polynomial, Kind::inverse, Kind::adaptive_time_series, Kind::feedforward_feedback}) {
    Ride ride(late_scene(), assuming(kind));
    ride.run.whole();
    ASSERT_EQ(ride.run.loop.trip().reason, Reason::reference_ended) << name(kind);
    EXPECT_LT(tracking_error(ride.run), 0.25 * before) << name(kind);
  }
}

// Law. What is on record is what was done: x_added is x_cmd less the deflection of the car, F_added what the method put
// on the measured force; without compensation there is none.
TEST(CompensatedControlLoop, RecordsWhatItAdds) {
  Ride plain(late_scene(500), std::nullopt);
  plain.run.whole();
  for (const Record& row : plain.run.records) {
    EXPECT_EQ(row.added.command, 0.0);
    EXPECT_EQ(row.added.force, 0.0);
  }
  auto settings = assuming(Kind::virtual_damping);
  settings.force_lead = 0.0;
  for (const bool leads : {true, false}) {
    Ride ride(late_scene(), leads ? assuming(Kind::inverse) : settings);
    ride.run.whole();
    double most_command = 0.0, most_force = 0.0;
    for (const Record& row : ride.run.rows(Mode::running)) {
      const double wanted = value(row, Channel::z_w) - value(row, Channel::z_b);
      EXPECT_NEAR(row.added.command, value(row, Channel::x_cmd) - wanted, 1e-15);
      if (!leads) {
        EXPECT_NEAR(row.added.force, 500.0 * (row.velocities.wheel - row.velocities.body), 1e-9);
      }
      most_command = std::max(most_command, std::abs(row.added.command));
      most_force = std::max(most_force, std::abs(row.added.force));
    }
    EXPECT_EQ(most_command > 1e-5, leads);
    EXPECT_GT(most_force, 1.0);
  }
}

// Law. The start does not jump: the first command of a run is the car's, what is added comes in by the smoothstep, and
// never changes faster than `rate`.
TEST(CompensatedControlLoop, StartsWithoutAJump) {
  auto settings = assuming(Kind::inverse);
  settings.start_ramp = 0.4;
  settings.rate = 0.05;
  Ride ride(late_scene(), settings);
  ride.run.whole();
  ASSERT_EQ(ride.run.loop.trip().reason, Reason::reference_ended);
  const auto rows = ride.run.rows(Mode::running);
  EXPECT_EQ(rows.front().added.command, 0.0);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_LE(std::abs(rows[k].added.command - rows[k - 1].added.command), settings.rate * h * (1.0 + 1e-9)) << k;
  }
  settings.start_ramp = 0.0;
  settings.rate = 100.0;
  Ride at_once(late_scene(), settings);
  at_once.run.whole();
  const auto others = at_once.run.rows(Mode::running);
  double most_ramped = 0.0, most_at_once = 0.0;
  for (std::size_t k = 1; k < 100; ++k) {  // within a quarter of the ramp at most 0.16 of it
    most_ramped = std::max(most_ramped, std::abs(rows[k].added.command));
    most_at_once = std::max(most_at_once, std::abs(others[k].added.command));
  }
  EXPECT_LE(most_ramped, 0.25 * most_at_once);
}

// Fault. More than it may add, to the command or to the force, ends the run with its own reason, the value and the
// limit; the command goes back to rest as after any trip.
TEST(CompensatedControlLoop, TripsWhenItAddsMoreThanItMay) {
  for (const bool of_force : {false, true}) {
    auto settings = assuming(Kind::inverse);
    (of_force ? settings.force_limit : settings.limit) = of_force ? 0.5 : 2e-4;
    Ride ride(late_scene(), settings);
    ride.run.whole();
    const firmware::Trip& trip = ride.run.loop.trip();
    EXPECT_EQ(trip.reason, Reason::compensation);
    EXPECT_EQ(trip.channel, of_force ? Channel::F : Channel::x_cmd);
    EXPECT_EQ(trip.limit, of_force ? 0.5 : 2e-4);
    EXPECT_GT(std::abs(trip.value), trip.limit);
    EXPECT_TRUE(is_fault(trip.reason));
    expect_safe_end(ride.run);
    EXPECT_EQ(ride.run.loop.command().position, ride.run.scene.settings.ramps.rest);
    for (const Record& row : ride.run.rows(Mode::safe)) EXPECT_EQ(row.added.command, 0.0);
  }
}

// Fault. A compensation whose numbers are none is no command: it trips before anything is written.
TEST(CompensatedControlLoop, NoNumberIsNoCommand) {
  class Broken final : public firmware::Compensation {
    void do_start(double /*deflection*/) override {}
    double do_force(double measured) override { return measured; }
    Answer do_command(const Instant& instant) override {
      const double nan = std::nan("");
      return {.command = {++periods_ > 100 ? nan : instant.wanted.position, 0.0, 0.0}};
    }
    int periods_ = 0;
  } broken;
  Journey run(late_scene());
  run.loop.attach(broken);
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::command_not_finite);
  expect_safe_end(run);
}

// Law. Stop, hold and resume act as they do without a compensation.
TEST(CompensatedControlLoop, StopsAndHoldsAsBefore) {
  Ride ride(late_scene(8000), assuming(Kind::adaptive_time_series));
  Journey& run = ride.run;
  run.loop.arm();
  run.loop.start();
  run.periods(1500);
  ASSERT_EQ(run.loop.mode(), Mode::running);
  run.loop.hold();
  run.periods(4000);
  ASSERT_EQ(run.loop.mode(), Mode::holding);
  EXPECT_LT(std::abs(run.records.back().added.command), 1e-5) << "the car is at rest: nothing to lead";
  run.loop.resume();
  run.periods(300);
  ASSERT_EQ(run.loop.mode(), Mode::running);
  run.loop.stop();
  run.periods(3000);
  EXPECT_EQ(run.loop.trip().reason, Reason::stop_requested);
  expect_safe_end(run);
}

// Law. A second run begins as the first one did: nothing of it is left in the compensation.
TEST(CompensatedControlLoop, BeginsEveryRunAfresh) {
  Ride ride(late_scene(800), assuming(Kind::adaptive_time_series));
  ride.run.whole();
  const auto first = ride.run.rows(Mode::running);
  ride.run.periods(8000);  // until the oil of the component is at rest
  ride.run.loop.acknowledge();
  ride.run.periods(2);
  ride.run.records.clear();
  ride.run.whole();
  const auto second = ride.run.rows(Mode::running);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_NEAR(first[k].added.command, second[k].added.command, 1e-9) << k;
  }
}

// Law. No heap.
TEST(CompensatedControlLoop, TakesNoHeap) {
  for (const Kind kind : {Kind::adaptive_time_series, Kind::smith}) {
    Scene scene = late_scene(2000);
    scene.journal = 2000;
    Ride ride(scene, assuming(kind));
    ride.run.loop.arm();
    ride.run.loop.start();
    support::without_heap([&] {
      std::size_t left = 1500;
      ride.run.loop.run([&left] { return left-- > 0; });
      return 0;
    });
    EXPECT_EQ(ride.run.loop.mode(), Mode::running);
  }
}

}  // namespace
}  // namespace compensated_loop_test
