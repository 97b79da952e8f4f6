// Sensors whose readings differ from the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/rig/rig_model.hpp"

namespace sensor_effects_test {
namespace {

using model::Channel;
using model::Signals;
using Sensors = model::Sensors<double>;

constexpr double period = 1e-3;
constexpr Channel channel = Channel::dz_b;

/// Readings of one channel with this sensor, for truths u(0), u(1), …
template <class Truth>
std::vector<double> readings(const model::SensorPath<double>& sensor, const Truth& truth, int count) {
  std::array<model::SensorPath<double>, model::channel_count> paths{};
  paths[index(channel)] = sensor;
  const Sensors sensors(paths, period);
  Sensors::State state;
  std::vector<double> out;
  for (int k = 0; k < count; ++k) {
    Signals<double> signals{};
    signals[index(channel)] = truth(k);
    if (k == 0) {
      sensors.start(state, signals, nullptr);
    } else {
      sensors.step(state, signals, nullptr);
    }
    Signals<double> read{};
    sensors.read(state, read);
    out.push_back(read[index(channel)]);
  }
  return out;
}

double ramp(int k) { return 0.5 * k * period; }

// Point. measured = gain · true + offset.
TEST(SensorGainAndOffset, ScaleAndShiftTheReading) {
  EXPECT_NEAR(readings({.gain = 1.02}, ramp, 5)[4], 1.02 * ramp(4), 1e-15);
  EXPECT_NEAR(readings({.offset = 0.003}, ramp, 5)[4], ramp(4) + 0.003, 1e-15);
}

// Law. A ramp through a first-order lag is late by T once settled, exactly: the input is a cubic between samples.
TEST(SensorLag, IsLateByItsTimeConstantOnARamp) {
  const double T = 0.005;
  EXPECT_NEAR(readings({.lag = T}, ramp, 200)[199], ramp(199) - 0.5 * T, 1e-12);  // e^{−40} of the start is left
}

// Law. Gain and phase at 30 Hz, 1 kHz: 1/(1 + iωT). A cubic through four samples is wrong by at most (ωh)⁴/24 = 5.3e-5
// of the amplitude (straight lines would be by (ωh)²/12 = 3e-3).
TEST(SensorLag, FollowsAFastSine) {
  const double T = 0.002, w = 2.0 * std::numbers::pi * 30.0;
  const auto read = readings(
      {.lag = T}, [&](int k) { return std::sin(w * k * period); }, 400);
  const double gain = 1.0 / std::sqrt(1.0 + w * w * T * T), phase = std::atan(w * T);
  for (int k = 100; k < 400; ++k) {  // e^{−50} of the start is left
    EXPECT_NEAR(read[static_cast<std::size_t>(k)], gain * std::sin(w * k * period - phase), 5.3e-5) << k;
  }
}

// Point. A whole delay gives the very sample, a fractional one the cubic between.
TEST(SensorDelay, ShowsWhatWasBefore) {
  const auto wave = [](int k) { return std::sin(0.1 * k); };
  EXPECT_EQ(readings({.delay = 0.007}, wave, 50)[40], wave(33));
  // 3/128 (0.1)⁴ = 2.4e-6 bounds the cubic's error
  EXPECT_NEAR(readings({.delay = 0.0073}, wave, 50)[40], std::sin(0.1 * (40 - 7.3)), 2.4e-6);
}

// Point. Between ± limit nothing happens, beyond it the limit stands, to the bit.
TEST(SensorSaturation, ClipsAtItsLimit) {
  const auto wave = [](int k) { return std::sin(0.1 * k); };
  const auto read = readings({.limit = 0.5}, wave, 64);
  for (int k = 0; k < 64; ++k) {
    const double u = wave(k);
    EXPECT_EQ(read[static_cast<std::size_t>(k)], u > 0.5 ? 0.5 : (u < -0.5 ? -0.5 : u)) << k;
  }
}

// Point. Renewed at the first sample and then every period; 3.5 samples take turns of 4 and 3.
TEST(SensorHold, RenewsItsReadingOncePerPeriod) {
  const auto count = [](int k) { return static_cast<double>(k); };
  const auto whole = readings({.hold = 0.003}, count, 10);
  const std::vector<double> by_three{0, 0, 0, 3, 3, 3, 6, 6, 6, 9};
  EXPECT_EQ(whole, by_three);
  const auto broken = readings({.hold = 0.0035}, count, 15);
  const std::vector<double> by_turns{0, 0, 0, 0, 4, 4, 4, 7, 7, 7, 7, 11, 11, 11, 14};
  EXPECT_EQ(broken, by_turns);
}

// Law. In a hil rig the reading of F goes around the loop: a sensor delay of F acts like the same delay of the machine
// on what the car feels.
TEST(SensorDelay, OfTheForceGoesAroundTheLoop) {
  model::RigParameters<double> rig;
  rig.kind = model::RigKind::hil;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, 1140.0};
  auto late_machine = rig, late_sensor = rig;
  late_machine.effects.add(model::ActuatorDelay<double>{0.010});
  late_sensor.effects.add(Channel::F, model::SensorDelay<double>{0.010});
  const model::RigModel<> a(late_machine, period), b(late_sensor, period);
  auto x = a.start(), y = b.start();
  double largest = 0.0;
  for (int k = 1; k <= 2000; ++k) {
    const double t = k * period, w = 2.0 * std::numbers::pi * 3.0;
    const model::Motion<double> road{0.01 * (1.0 - std::cos(w * t)), 0.01 * w * std::sin(w * t), 0.0};
    a.step(x, {.foot_point = road});
    b.step(y, {.foot_point = road});
    largest = std::max(largest, std::abs(a.signals(x)[index(Channel::z_w)] - b.signals(y)[index(Channel::z_w)]));
  }
  // The component is linear and memoryless, so both loops are the same but for rounding.
  EXPECT_LT(largest, 1e-14);
}

// Law. Noise passes through a sensor with an effect, and is added by the reading of one without.
TEST(Sensors, PassNoiseThroughTheirEffects) {
  model::RigParameters<double> rig;
  rig.kind = model::RigKind::component_bench;
  rig.suspension = {1000.0, 0.0};
  auto clipping = rig;
  clipping.effects.add(Channel::F, model::SensorSaturation<double>{5.0});
  Signals<double> noise{};
  noise[index(Channel::F)] = 7.0;
  noise[index(Channel::x_act)] = 1e-3;
  for (const bool clips : {false, true}) {
    const model::RigModel<> model(clips ? clipping : rig, period);
    auto x = model.start();
    model.step(x, {.command = {0.001, 0.0}, .noise = &noise});
    const auto read = model.measured(x, &noise);
    EXPECT_NEAR(read[index(Channel::F)], clips ? 5.0 : 8.0, 1e-12);
    EXPECT_NEAR(read[index(Channel::x_act)], 0.002, 1e-15);
    EXPECT_NEAR(model.signals(x)[index(Channel::F)], 1.0, 1e-12) << "the truth knows no sensor";
  }
}

}  // namespace
}  // namespace sensor_effects_test
