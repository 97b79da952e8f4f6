#include "firmware/loop/estimator/state_estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

namespace state_estimator_test {
namespace {

using firmware::Limits;
using firmware::Observers;
using firmware::SampleGuard;
using firmware::StateEstimator;
using model::Channel;

constexpr hal::Time ms = hal::milliseconds(1);
constexpr double h = 1e-3;
constexpr double tyre_stiffness = 2e5;

class Sensors final : public hal::SensorSource {
 public:
  explicit Sensors(const hal::SensorSetup& setup) : SensorSource(setup) {}

 private:
  hal::Result<hal::Frame> do_read() override { return hal::Fault::timeout; }
};

hal::SensorSetup setup_of(std::initializer_list<Channel> channels) {
  hal::SensorSetup setup;
  for (const Channel c : channels) setup[model::index(c)].fitted = true;
  return setup;
}

/// Foot point, wheel and body on straight lines of 0.3, 0.2 and 0.1 m/s from rest places of their own.
double value(Channel channel, double t) {
  const double z_r = 0.01 + 0.3 * t, z_w = 0.02 + 0.2 * t, z_b = 0.03 + 0.1 * t;
  switch (channel) {
    case Channel::z_r:
      return z_r;
    case Channel::z_w:
      return z_w;
    case Channel::z_b:
      return z_b;
    case Channel::dz_w:
      return z_r - z_w;
    case Channel::dz_b:
    case Channel::x_act:
      return z_w - z_b;
    default:
      return 0.0;
  }
}

/// What is estimated after 10 s on these lines: the start (at rest) is forgotten with e^{−31}.
struct Estimate {
  explicit Estimate(std::initializer_list<Channel> channels, double stiffness = tyre_stiffness)
      : sensors(setup_of(channels)),
        samples(Limits{}, ms, sensors),
        estimator(samples, stiffness, Observers{}, h),
        fitted(channels) {
    for (; period < 10'000; ++period) {
      samples.take(frame(), ms * period);
      estimator.step(samples);
    }
  }
  hal::Frame frame() const {
    hal::Frame f;
    for (const Channel c : fitted) {
      f.channels[model::index(c)] = {value(c, h * static_cast<double>(period)), ms * period, hal::Quality::good};
    }
    return f;
  }
  double time() const { return h * static_cast<double>(period - 1); }

  Sensors sensors;
  SampleGuard samples;
  StateEstimator estimator;
  std::vector<Channel> fitted;
  std::int64_t period = 0;
};

void expect_velocities(const Estimate& e, double foot_point, double wheel, double body, double deflection) {
  const auto near = [](double estimated, double expected) {
    return std::isnan(expected) ? std::isnan(estimated) : std::abs(estimated - expected) < 1e-9;
  };
  const auto& v = e.estimator.velocities();
  EXPECT_TRUE(near(v.foot_point, foot_point)) << v.foot_point;
  EXPECT_TRUE(near(v.wheel, wheel)) << v.wheel;
  EXPECT_TRUE(near(v.body, body)) << v.body;
  EXPECT_TRUE(near(v.deflection, deflection)) << v.deflection;
}

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Rigs are fitted differently; what follows from what is there is estimated, what does not is no number. On straight
// lines all sources agree, with accelerometers (which show 0) and without.
TEST(StateEstimator, EstimatesWhatFollowsFromWhatIsFitted) {
  using enum Channel;
  expect_velocities(Estimate{z_r, dz_w, dz_b}, 0.3, 0.2, 0.1, 0.1);
  expect_velocities(Estimate{z_r, dz_w, dz_b, zdd_r, zdd_w, zdd_b}, 0.3, 0.2, 0.1, 0.1);
  expect_velocities(Estimate{z_r, z_w, z_b}, 0.3, 0.2, 0.1, 0.1);
  expect_velocities(Estimate{z_w, dz_b}, none, 0.2, 0.1, 0.1);
  expect_velocities(Estimate{z_r, dz_b}, 0.3, none, none, 0.1);
  expect_velocities(Estimate{dz_w, dz_b}, none, none, none, 0.1);
  expect_velocities(Estimate{z_r, dz_w}, 0.3, 0.2, none, none);
  expect_velocities(Estimate{z_w, dz_w, x_act}, none, 0.2, none, 0.1);
  expect_velocities(Estimate{z_b, dz_b}, none, none, 0.1, 0.1);
  expect_velocities(Estimate{x_act, F}, none, none, none, 0.1);
  expect_velocities(Estimate{F}, none, none, none, none);
  expect_velocities(Estimate{zdd_w}, none, 0.0, none, none);
}

// Point (4): k_t dz_w, from the laser or from the two displacements around the tyre.
TEST(StateEstimator, FeelsTheWheelLoadThroughTheTyre) {
  using enum Channel;
  const Estimate laser{dz_w};
  EXPECT_DOUBLE_EQ(laser.estimator.wheel_load(), tyre_stiffness * value(dz_w, laser.time()));
  const Estimate difference{z_r, z_w};
  EXPECT_DOUBLE_EQ(difference.estimator.wheel_load(), tyre_stiffness * value(dz_w, difference.time()));
  EXPECT_TRUE(std::isnan(Estimate{z_r}.estimator.wheel_load()));
  EXPECT_TRUE(std::isnan(Estimate({dz_w}, 0.0).estimator.wheel_load())) << "a rig without tyre";
}

// Absolute displacements beat sums of relative ones: a laser less is noise less.
TEST(StateEstimator, PrefersWhatIsMeasuredDirectly) {
  using enum Channel;
  Estimate e{z_r, z_w, dz_w, z_b, dz_b};
  hal::Frame frame = e.frame();
  frame.channels[model::index(dz_b)].value += 1.0;   // would throw the body far off
  frame.channels[model::index(z_r)].value += 0.001;  // would move the wheel
  e.samples.take(frame, ms * e.period);
  e.estimator.step(e.samples);
  EXPECT_NEAR(e.estimator.velocities().wheel, 0.2, 1e-9);
  EXPECT_NEAR(e.estimator.velocities().body, 0.1, 1e-9);
  EXPECT_NEAR(e.estimator.wheel_load(), tyre_stiffness * value(dz_w, h * static_cast<double>(e.period)), 1e-6);
}

// The observers start where the rig stands. Before every fitted channel has shown it, there is nothing to start from.
TEST(StateEstimator, WaitsForTheFirstSampleOfEveryChannel) {
  const Sensors sensors(setup_of({Channel::z_r, Channel::dz_w}));
  SampleGuard samples(Limits{}, ms, sensors);
  StateEstimator estimator(samples, tyre_stiffness, Observers{}, h);
  for (int k = 0; k < 10; ++k) {
    hal::Frame frame;
    frame.channels[model::index(Channel::z_r)] = {0.1, ms * k, hal::Quality::good};
    if (k >= 5) frame.channels[model::index(Channel::dz_w)] = {0.05, ms * k, hal::Quality::good};
    samples.take(frame, ms * k);
    estimator.step(samples);
    if (k < 5) {
      EXPECT_TRUE(std::isnan(estimator.velocities().wheel)) << k;
      EXPECT_TRUE(std::isnan(estimator.wheel_load())) << k;
    } else {
      EXPECT_NEAR(estimator.velocities().wheel, 0.0, 1e-12) << "at rest at 50 mm, not falling from 100";
      EXPECT_DOUBLE_EQ(estimator.wheel_load(), tyre_stiffness * 0.05);
    }
  }
}

}  // namespace
}  // namespace state_estimator_test
