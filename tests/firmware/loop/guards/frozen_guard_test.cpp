#include "firmware/loop/guards/frozen_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "tests/firmware/loop/rig_under_test.hpp"
#include "tests/firmware/loop/silent_sensors.hpp"
#include "tests/support/without_heap.hpp"

namespace frozen_guard_test {
namespace {

using namespace rig_under_test;
using firmware::FrozenGuard;
using firmware::Limits;
using firmware::Reason;
using firmware::SampleGuard;
using firmware::Supervision;
using firmware::Trip;
using model::RigKind;

struct Watched {
  Watched(const Parameters& rig, const std::vector<Channel>& channels, const Supervision& supervision = Supervision{},
          double period = h)
      : sensors(fitted(channels)), samples(Limits{}, hal::seconds(period), sensors), guard(supervision, rig, period) {}

  static hal::SensorSetup fitted(const std::vector<Channel>& channels) {
    hal::SensorSetup setup;
    for (const Channel channel : channels) setup[model::index(channel)].fitted = true;
    return setup;
  }

  /// One period in which every fitted channel shows the value.
  std::optional<Trip> show(double value, const hal::Command& command) {
    hal::Frame frame;
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      if (sensors.fitted(i)) frame.channels[i] = {value, {}, hal::Quality::good};
    }
    samples.take(frame, {});
    return guard.follow(samples, command.position, command);
  }

  SilentSensors sensors;
  SampleGuard samples;
  FrozenGuard guard;
};

hal::Command sine(double t, double amplitude, double frequency) {
  const double w = two_pi * frequency;
  return {amplitude * std::sin(w * t), amplitude * w * std::cos(w * t), -amplitude * w * w * std::sin(w * t)};
}

// F constantly 0 while the machine moves was status 0. The value that it stops at does not matter.
TEST(FrozenGuard, TripsOnAForceThatNeverChanges) {
  for (const double stuck : {0.0, 812.5}) {
    Watched watched(paper_rig(RigKind::hil), {Channel::F});
    std::optional<Trip> hazard;
    int k = 0;
    for (; k < 2000 && !hazard; ++k) hazard = watched.show(stuck, sine(h * k, 10e-3, 1.0));
    ASSERT_TRUE(hazard);
    EXPECT_EQ(hazard->reason, Reason::sensor_frozen);
    EXPECT_EQ(hazard->channel, Channel::F);
    EXPECT_EQ(hazard->value, stuck);
    EXPECT_EQ(hazard->limit, 0.2);
    EXPECT_EQ(k, 201) << "the first sample, and 200 that are the same";
  }
}

// Law. A frozen sensor is found after the same time at every sample rate: here x_act of a drive that moves at 1 Hz.
TEST(FrozenGuard, JudgesByTime) {
  for (const double period : {2e-3, 1e-3, 0.2e-3}) {
    Watched watched(paper_rig(RigKind::hil), {Channel::x_act}, {}, period);
    std::optional<Trip> hazard;
    double t = 0.0;
    for (int k = 0; t < 2.0 && !hazard; ++k) hazard = watched.show(0.0, sine(t = period * k, 10e-3, 1.0));
    EXPECT_NEAR(t, 0.2, 1e-9) << period;
  }
}

// At rest, and in motions that a sensor need not resolve, a quantised sensor shows the same count for hours.
TEST(FrozenGuard, LetsAQuantisedSensorRest) {
  for (const Channel channel : {Channel::F, Channel::x_act}) {
    Watched watched(paper_rig(RigKind::hil), {channel});
    for (int k = 0; k < 100'000; ++k) ASSERT_FALSE(watched.show(0.3, sine(h * k, 0.9e-3, 1.0))) << k;
  }
}

// 199 equal samples, one that differs: a slow sensor, not a dead one.
TEST(FrozenGuard, CountsFromTheLastChange) {
  Watched watched(paper_rig(RigKind::hil), {Channel::F});
  for (int k = 0; k < 10'000; ++k) ASSERT_FALSE(watched.show(k / 199, sine(h * k, 50e-3, 1.0))) << k;
}

// The slowest motion in which each sensor of the paper's quarter car changes by few counts only, noise-free: sines
// between 0.02 and 30 Hz whose speed is the limit or whose acceleration is 17 m/s² (rms of a class B road).
// The rig answers with the steady state of its model; each channel is rounded to its count.
TEST(FrozenGuard, NeverTripsOnAQuantisedQuarterCar) {
  const std::vector<std::pair<Channel, double>> counts{{Channel::z_r, 4.196e-6},      {Channel::zdd_w, 2.991e-3},
                                                       {Channel::zdd_b, 2.991e-3},    {Channel::F_w, 0.30518},
                                                       {Channel::dz_w, 0.25 / 16384}, {Channel::dz_b, 0.25 / 16384}};
  for (const double frequency : {0.02, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0}) {
    for (const double speed : {0.02, 0.06, 0.2, 0.7}) {
      const double w = two_pi * frequency, amplitude = std::min(speed / w, 17.0 / (w * w));
      if (amplitude > half_stroke) continue;
      const Parameters parameters = paper_rig(RigKind::quarter_car);
      ModelPlant::Model model(parameters, h);
      auto state = model.start(0.0);
      std::vector<Channel> channels;
      for (const auto& [channel, count] : counts) channels.push_back(channel);
      Supervision half;  // of the thresholds: a margin of two
      half.frozen_speed *= 0.5;
      half.frozen_acceleration *= 0.5;
      Watched watched(parameters, channels, half);
      for (int k = 0; k < 8000; ++k) {
        // faded in over two seconds: the rig's own motion shall not help
        const double fade = std::min(1.0, 0.5 * h * k);
        const hal::Command command = sine(h * k, fade * amplitude, frequency);
        ModelPlant::Model::Input in;
        in.foot_point = {command.position, command.velocity, command.acceleration};
        model.step(state, in);
        const auto truth = model.measured(state);
        hal::Frame frame;
        for (const auto& [channel, count] : counts) {
          const double value = count * std::round(truth[model::index(channel)] / count);
          frame.channels[model::index(channel)] = {value, {}, hal::Quality::good};
        }
        watched.samples.take(frame, {});
        const auto hazard = watched.guard.follow(watched.samples, command.position, command);
        ASSERT_FALSE(hazard) << model::name(*hazard->channel) << " at " << frequency << " Hz, " << speed << " m/s";
      }
    }
  }
}

// … and each of them is found on a class B road's typical motion once it stops.
TEST(FrozenGuard, FindsEachChannelOfAQuarterCar) {
  for (const Channel channel :
       {Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b, Channel::F_w, Channel::dz_w, Channel::dz_b}) {
    Watched watched(paper_rig(RigKind::quarter_car), {channel});
    std::optional<Trip> hazard;
    int k = 0;
    for (; k < 1000 && !hazard; ++k) hazard = watched.show(1.5, sine(h * k, 5e-3, 3.0));
    ASSERT_TRUE(hazard) << model::name(channel);
    EXPECT_EQ(hazard->channel, channel);
    EXPECT_LT(k, 400);
  }
}

// What the rig description lets stand still is no fault.
TEST(FrozenGuard, KnowsWhatMayStandStill) {
  const auto trips = [](const Parameters& rig, Channel channel, double amplitude) {
    Watched watched(rig, {channel});
    for (int k = 0; k < 1000; ++k) {
      if (watched.show(0.0, sine(h * k, amplitude, 2.0))) return true;
    }
    return false;
  };
  Parameters rig = paper_rig(RigKind::hil);
  EXPECT_TRUE(trips(rig, Channel::F, 2e-3));
  rig.effects.get<model::Backlash>().active = true;
  rig.effects.get<model::Backlash>().effect.gap = 5e-3;
  EXPECT_FALSE(trips(rig, Channel::F, 3e-3)) << "6 mm of way in 5 mm of free play and 2 mm";
  EXPECT_TRUE(trips(rig, Channel::F, 4e-3));

  rig = paper_rig(RigKind::component_bench);
  auto& limit = rig.effects.get<model::SensorSaturation>(Channel::F);
  limit.active = true;
  limit.effect.limit = 500.0;
  EXPECT_FALSE(trips(rig, Channel::F, 20e-3));

  rig = paper_rig(RigKind::component_bench);
  rig.has_fdva = false;
  rig.suspension.stiffness = 0.0;
  EXPECT_FALSE(trips(rig, Channel::F, 20e-3)) << "dry friction alone would be constant";

  Supervision off;
  off.frozen_time = 0.0;
  Watched watched(paper_rig(RigKind::hil), {Channel::F}, off);
  for (int k = 0; k < 1000; ++k) EXPECT_FALSE(watched.show(0.0, sine(h * k, 20e-3, 2.0)));
}

TEST(FrozenGuard, TakesNoHeap) {
  Watched watched(paper_rig(RigKind::hil), {Channel::F});
  EXPECT_FALSE(support::without_heap([&] { return watched.show(0.0, {}); }));
}

}  // namespace
}  // namespace frozen_guard_test
