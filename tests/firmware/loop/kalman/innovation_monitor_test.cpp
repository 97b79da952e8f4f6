// The innovation monitor: a false-alarm rate that holds, and what it sees.
#include "firmware/loop/kalman/innovation_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/firmware/loop/kalman/linear_car.hpp"

namespace {

using firmware::InnovationMonitor;

// Point. Quantiles of the normal distribution from a table.
TEST(InnovationMonitor, KnowsTheNormalDistribution) {
  EXPECT_NEAR(firmware::normal_quantile(0.15865525393145707), 1.0, 1e-6);
  EXPECT_NEAR(firmware::normal_quantile(0.0227501319481792), 2.0, 1e-6);
  EXPECT_NEAR(firmware::normal_quantile(2.866515718791946e-7), 5.0, 1e-5);
}

// Law. White innovations of unit variance lead to as many alarms as were allowed: 1000 an hour over 2000 blocks of four
// channels (4096 ms each, 500 blocks in time) are 569; the number scatters like Poisson's, 3 σ = 72, and Bonferroni's
// bound is an upper one.
TEST(InnovationMonitor, HoldsItsFalseAlarmRate) {
  constexpr double rate = 1000.0;
  constexpr int channels = 4, blocks = 500;
  InnovationMonitor monitor(channels, 1e-3, rate);
  support::Normal normal(21);
  for (int k = 0; k < (blocks + InnovationMonitor::settling) * InnovationMonitor::block; ++k) {
    for (int c = 0; c < channels; ++c) monitor.take(c, normal());
  }
  EXPECT_EQ(monitor.blocks(), 4U * blocks);
  const double expected = rate / 3600.0 * blocks * InnovationMonitor::block * 1e-3;
  EXPECT_NEAR(monitor.alarms(), expected, 3.0 * std::sqrt(expected));
}

InnovationMonitor::Test found(double level, double scale, double colour) {
  InnovationMonitor monitor(1, 1e-3, 1e-2);
  support::Normal normal(22);
  double before = normal();
  for (int k = 0; k < (InnovationMonitor::settling + 2) * InnovationMonitor::block; ++k) {
    const double now = colour * before + std::sqrt(1.0 - colour * colour) * normal();
    before = now;
    monitor.take(0, level + scale * now);
  }
  return monitor.model_wrong() ? monitor.last().test : InnovationMonitor::Test::none;
}

// Point. Each statistic sees its own contradiction: half a standard deviation of level, 20 % of size either way, a
// correlation of 0.2.
TEST(InnovationMonitor, SeesLevelVarianceAndColour) {
  EXPECT_EQ(found(0.0, 1.0, 0.0), InnovationMonitor::Test::none);
  EXPECT_NE(found(0.5, 1.0, 0.0), InnovationMonitor::Test::none);
  EXPECT_EQ(found(0.0, 1.2, 0.0), InnovationMonitor::Test::variance);
  EXPECT_EQ(found(0.0, 0.8, 0.0), InnovationMonitor::Test::variance);
  EXPECT_EQ(found(0.0, 1.0, 0.2), InnovationMonitor::Test::colour);
}

// Law. What is set aside is not judged, and the rest is judged as it would be alone; a block most of which is set aside
// says that the road is another. A sixth of the samples that are ten times too large would be a variance of 17.
TEST(InnovationMonitor, DoesNotJudgeWhatIsSetAside) {
  for (const int every : {6, 0}) {
    InnovationMonitor monitor(1, 1e-3, 1e-2);
    support::Normal normal(23);
    for (int k = 0; k < (InnovationMonitor::settling + 2) * InnovationMonitor::block; ++k) {
      const bool aside = every == 0 ? k % 3 != 0 : k % every == 0;
      if (aside) {
        monitor.set_aside(0);
      } else {
        monitor.take(0, normal());
      }
    }
    EXPECT_EQ(monitor.blocks(), 2U);
    EXPECT_EQ(monitor.last().test, every == 0 ? InnovationMonitor::Test::road : InnovationMonitor::Test::none);
    EXPECT_NEAR(monitor.last().statistic, every == 0 ? 2.0 / 3.0 : 0.0, 1e-3);
  }
}

}  // namespace
