// The input before its sensor, computed from the samples of that sensor.
#include "host_sim/identification/predict/true_input.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/rig_texts.hpp"

namespace {

using namespace host_sim;
using namespace host_sim::identification;
using model::Channel;

constexpr double h = 1e-3, omega = 2.0 * std::numbers::pi * 12.0, amplitude = 2e-3;

model::Motion<double> motion_at(double phase, double size) {
  return {size * std::sin(phase), size * omega * std::cos(phase), -size * omega * omega * std::sin(phase)};
}

/// A wheel's 12 Hz as a sensor of gain, lag and delay shows it; without dz_b one channel would be all beside it.
PreparedRecording wheel_seen_with(double gain, double lag, double delay) {
  PreparedRecording r;
  r.channels = {Channel::zdd_b, Channel::dz_b};
  r.input.channel = Channel::zdd_w;
  r.input.period = h;
  const double size = gain * amplitude / std::hypot(1.0, omega * lag), late = std::atan(omega * lag) + omega * delay;
  for (int k = 0; k < 1000; ++k) r.input.motion.push_back(motion_at(omega * h * k - late, size));
  return r;
}

Hypothesis car_with(const char* effect, Channel channel, double value) {
  auto rig = firmware::parse_rig(std::string(support::quarter_car_text), "car.toml").rig;
  firmware::put_effect(rig, {firmware::find_effect(effect), channel, {value}});
  return {rig, {}};
}

void expect_undone(const char* effect, double value, const PreparedRecording& seen) {
  const auto truth = true_input(car_with(effect, Channel::zdd_w, value), seen, seen.input, InitialState::Constant(0.5));
  ASSERT_TRUE(truth) << effect;
  // The acceleration of a lag by differences over two samples: (ωh)²/6 = 9.5e-4 of ωT = 0.23; a polynomial of fifth
  // order is wrong by less. Behind the end nothing is known: the last 10 samples are not compared.
  constexpr double error = 3e-4;
  for (int k = 1; k < 990; ++k) {
    const auto& found = truth->input.motion[static_cast<std::size_t>(k)];
    const auto wanted = motion_at(omega * h * k, amplitude);
    ASSERT_NEAR(found.position, wanted.position, error * amplitude) << effect << k;
    ASSERT_NEAR(found.velocity, wanted.velocity, error * amplitude * omega) << effect << k;
    ASSERT_NEAR(found.acceleration, wanted.acceleration, error * amplitude * omega * omega) << effect << k;
  }
  // The car begins as far from the wheel, and as fast, as it was estimated to.
  const auto &first = truth->input.motion[0], &read = seen.input.motion[0];
  EXPECT_DOUBLE_EQ(truth->start(0) - first.position, 0.5 - read.position);
  EXPECT_DOUBLE_EQ(truth->start(3) - first.velocity, 0.5 - read.velocity);
  EXPECT_DOUBLE_EQ(truth->start(4), 0.5);
}

// Law. (1) and (2) of true_input.hpp.
TEST(TrueInput, IsWhatWasBeforeTheSensor) {
  expect_undone("sensor_gain", 1.1, wheel_seen_with(1.1, 0.0, 0.0));
  expect_undone("sensor_lag", 3e-3, wheel_seen_with(1.0, 3e-3, 0.0));
  expect_undone("sensor_delay", 4.6e-3, wheel_seen_with(1.0, 0.0, 4.6e-3));
}

// Point. Nothing is undone of a sensor that is as described, of another channel's, where two sensors say how the input
// moves, and where a single channel might as well be wrong.
TEST(TrueInput, IsTheInputWhereItsSensorSaysNothing) {
  PreparedRecording seen = wheel_seen_with(1.0, 0.0, 0.0);
  const InitialState start = InitialState::Zero();
  const auto gain = car_with("sensor_gain", Channel::zdd_w, 1.1);
  EXPECT_TRUE(true_input(gain, seen, seen.input, start));
  EXPECT_FALSE(true_input(car_with("sensor_gain", Channel::zdd_b, 1.1), seen, seen.input, start));
  EXPECT_FALSE(true_input(car_with("coulomb_friction", Channel::zdd_w, 30.0), seen, seen.input, start));
  seen.channels.pop_back();
  EXPECT_FALSE(true_input(gain, seen, seen.input, start));
  seen = wheel_seen_with(1.0, 0.0, 0.0);
  seen.inputs_fused = true;
  EXPECT_FALSE(true_input(gain, seen, seen.input, start));
}

// Point. What a sensor cut off cannot be found again, and what it held only where its renewals are known.
TEST(TrueInput, KnowsWhatCanBeUndone) {
  PreparedRecording seen = wheel_seen_with(1.0, 0.0, 0.0);
  for (const char* effect : {"sensor_gain", "sensor_lag", "sensor_delay"}) {
    EXPECT_TRUE(can_be_undone(*firmware::find_effect(effect), seen, Channel::zdd_w)) << effect;
  }
  for (const char* effect : {"sensor_offset", "sensor_saturation", "sensor_hold"}) {
    EXPECT_FALSE(can_be_undone(*firmware::find_effect(effect), seen, Channel::zdd_w)) << effect;
  }
  seen.renewals[index(Channel::zdd_w)] = Renewals{};
  EXPECT_TRUE(can_be_undone(*firmware::find_effect("sensor_hold"), seen, Channel::zdd_w));
}

}  // namespace
