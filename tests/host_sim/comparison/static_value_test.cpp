// Constants of sensors that no motion makes are recognised and taken off; what motion makes is left.
#include "host_sim/comparison/static_value.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/host_sim/identification/test_signals.hpp"

namespace static_value_test {
namespace {

using namespace host_sim;
using model::Channel;

model::RigParameters<double> car() {
  model::RigParameters<double> rig;
  rig.kind = model::RigKind::quarter_car;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  return rig;
}

firmware::Recording with(Channel channel, double mean, double amplitude) {
  firmware::Recording recording;
  recording.sample_period = 1e-3;
  recording[channel] = sample::sine(amplitude, 3.0, 4000);
  for (double& v : recording[channel]) v += mean;
  recording.time.resize(4000);
  return recording;
}

// Point. 330 kg weigh 3237 N: a load cell that was not tared shows it, whatever the motion; half of it is the border
// between an offset and the load.
TEST(StaticValue, KnowsTheWheelLoad) {
  for (const double mean : {3500.0, 3237.0, -3300.0, 1700.0}) {
    firmware::Recording recording = with(Channel::F_w, mean, 2900.0);
    const auto found = static_values(car(), recording);
    ASSERT_EQ(found.size(), 1U) << mean;
    EXPECT_EQ(found[0].kind, StaticValue::Kind::wheel_load);
    EXPECT_NEAR(found[0].value, mean, 30.0);
    EXPECT_NEAR(found[0].expected, 3237.3, 0.1);
    tare(found, recording);
    double sum = 0.0;
    for (const double v : recording[Channel::F_w]) sum += v;
    EXPECT_NEAR(sum / 4000.0, 0.0, 1e-9);
  }
  EXPECT_TRUE(static_values(car(), with(Channel::F_w, 900.0, 500.0)).empty());  // an offset: an effect
  const std::string text = words(static_values(car(), with(Channel::F_w, 3500.0, 500.0)).front());
  EXPECT_NE(text.find("F_w holds the static wheel load, 3500 N (described: 3237 N)"), std::string::npos) << text;
}

// Point. A sensor that feels gravity; a laser 250 mm away. A motion that comes near its own size stays as it is, and so
// does a step from rest.
TEST(StaticValue, KnowsGravityAndDistances) {
  EXPECT_EQ(static_values(car(), with(Channel::zdd_b, 9.81, 3.0)).front().kind, StaticValue::Kind::gravity);
  EXPECT_TRUE(static_values(car(), with(Channel::zdd_b, 0.5, 3.0)).empty());
  EXPECT_EQ(static_values(car(), with(Channel::dz_b, 0.25, 0.02)).front().kind, StaticValue::Kind::unknown);
  EXPECT_TRUE(static_values(car(), with(Channel::dz_b, 0.02, 0.02)).empty());
  firmware::Recording step = with(Channel::dz_b, 0.0, 0.0);
  for (std::size_t k = 100; k < 4000; ++k) step[Channel::dz_b][k] = 0.01;
  EXPECT_TRUE(static_values(car(), step).empty());
  model::RigParameters<double> bench;
  bench.kind = model::RigKind::component_bench;
  EXPECT_TRUE(static_values(bench, with(Channel::x_act, 0.25, 0.02)).empty());
  EXPECT_EQ(static_values(bench, with(Channel::F, 900.0, 100.0)).size(), 1U);
}

// Samples that say nothing do not count.
TEST(StaticValue, LeavesOutWhatSaysNothing) {
  firmware::Recording recording = with(Channel::F_w, 3500.0, 500.0);
  recording[Channel::F_w][7] = 1e9;
  UnusableSamples unusable;
  unusable[index(Channel::F_w)].assign(4000, false);
  unusable[index(Channel::F_w)][7] = true;
  EXPECT_NEAR(static_values(car(), recording, unusable).front().value, 3500.0, 5.0);
}

}  // namespace
}  // namespace static_value_test
