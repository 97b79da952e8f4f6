#include "host_sim/comparison/fine_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "host_sim/commands/common/recorded_as.hpp"
#include "host_sim/comparison/comparison.hpp"
#include "tests/support/reference_parameters.hpp"

namespace {

using model::Channel;
using model::RigKind;

// Point. 1 ms and 2.5 ms in steps of 0.25 ms; where the steps of a recording may be six times as long, these may be, too.
TEST(FineSteps, FollowThePeriod) {
  EXPECT_EQ(host_sim::fine_steps(1e-3), 4);
  EXPECT_EQ(host_sim::fine_steps(2.5e-3), 10);
  EXPECT_EQ(host_sim::fine_steps(6e-3, 6.0), 4);
  EXPECT_EQ(host_sim::fine_steps(1e-4), 1);
}

// What bends is stepped finely, a corner or none, as effect and as curve; what is a matrix is not.
TEST(FineSteps, AreTakenWhereForcesBend) {
  const auto plain = support::linear_rig(RigKind::component_bench);
  EXPECT_EQ(host_sim::steps_of(plain, 1e-3, 4), 1);
  auto linear = plain;
  linear.effects.add(model::ViscousDamping<double>{100.0});
  linear.effects.add(model::TopMount<double>{3e5});
  EXPECT_EQ(host_sim::steps_of(linear, 1e-3, 4), 1);
  auto cubic = plain, friction = plain, law = plain;
  cubic.effects.add(model::ProgressiveSpring<double>{1e6});
  friction.effects.add(model::CoulombFriction<double>{10.0});
  auto& curve = law.laws.curves[law.laws.curve_count++];
  curve.place = model::LawPlace::suspension;
  curve.over = model::LawOver::deflection;
  for (const double x : {-1.0, 0.0, 1.0}) {
    curve.at[curve.count] = x;
    curve.value[curve.count++] = 10.0 * x;
  }
  EXPECT_FALSE(host_sim::has_corners(cubic));
  EXPECT_TRUE(host_sim::has_corners(friction));
  for (const auto& rig : {cubic, friction, law}) EXPECT_EQ(host_sim::steps_of(rig, 1e-3, 4), 4);
}

// Law. Noise of x_act above its motion is no motion: on a damper of 15 kN s/m 1 µm at 1 kHz is some 8 N. Velocity noise of
// white noise grows with f, so of its power the share (f_e/500 Hz)³ is left below an edge of 10 + 32 Hz: 2.4 % of
// its rms; a tenth is asked for.
TEST(RecordedAs, TakesTheNoiseOfADisplacementAway) {
  firmware::RigDescription rig;
  rig.source = "RIG.toml";
  rig.sample_rate = 1000.0;
  rig.rig.kind = RigKind::component_bench;
  rig.rig.suspension.damping = 15e3;
  firmware::Recording recording;
  recording.source = "REC.csv";
  recording.sample_period = 1e-3;
  recording.time = firmware::sample_times(8000, 1000.0);
  std::mt19937_64 random(20261201);
  std::normal_distribution<double> noise(0.0, 1e-6);
  const double w = 4.0 * std::numbers::pi;
  for (const double t : recording.time) {
    recording[Channel::x_act].push_back(5e-3 * std::sin(w * t) + noise(random));
    recording[Channel::F].push_back(15e3 * 5e-3 * w * std::cos(w * t) + 1e5 * noise(random));
  }
  const auto error = [&](const host_sim::RecordedAs& as) {
    const host_sim::ComparedRecording compared(rig, recording, host_sim::StartChoice::automatic, as);
    return compared.compare(compared.simulate(rig.rig)).channels.at(0).error_rms;
  };
  const double raw = error({});
  EXPECT_GT(raw, 5.0);
  EXPECT_LT(error(host_sim::recorded_as(rig)), 0.1 * raw);
}

}  // namespace
