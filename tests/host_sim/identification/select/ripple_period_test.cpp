// The period of a ripple in what a model leaves of a force.
#include "host_sim/identification/select/ripple_period.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace {

using host_sim::identification::ripple_period;

struct Record {
  std::vector<double> travel, force;
};

/// Half a minute of three sines within ± 20 mm, and noise of 2 N, with a ripple of that size.
Record record(double period, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<> noise(0.0, 2.0);
  Record r;
  for (int k = 0; k < 30'000; ++k) {
    const double t = 1e-3 * k;
    r.travel.push_back(0.012 * std::sin(2.0 * t) + 0.006 * std::sin(11.3 * t) + 0.002 * std::sin(41.7 * t));
    r.force.push_back(size * std::sin(2.0 * std::numbers::pi * r.travel.back() / period + 0.7) + noise(random));
  }
  return r;
}

// Law. A ripple of half the noise is found at its period, within the half step 1/(8X) of the grid, seeds 1 to 5.
TEST(RipplePeriod, IsFoundInNoise) {
  for (const double period : {2e-3, 5e-3, 9e-3}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const Record r = record(period, 1.0, seed);
      EXPECT_NEAR(ripple_period(r.travel, r.force) / period, 1.0, 1.1 * period / (8.0 * 0.0395)) << period;
    }
  }
}

// The cogging of a motor, 72 periods of its turn at constant speed there and back: the grid goes as far as the samples
// tell periods apart, here 13 a period. The refined period keeps the phase to an eighth of a turn over all 72.
TEST(RipplePeriod, IsFoundAsFarAsTheSamplesTellPeriodsApart) {
  std::mt19937 random(7);
  std::normal_distribution<> noise(0.0, 1.0);
  Record r;
  const double range = 0.0628, period = range / 72.3;
  for (int k = 0; k < 8000; ++k) {
    const double turn = std::fmod(k / 1000.0, 2.0);
    r.travel.push_back(range * (turn < 1.0 ? turn : 2.0 - turn));
    r.force.push_back(std::sin(2.0 * std::numbers::pi * r.travel.back() / period) + noise(random));
  }
  EXPECT_NEAR(ripple_period(r.travel, r.force) / period, 1.0, 1.0 / (8.0 * 72.3));
}

// Law. Noise alone has none: one of a thousand records would, of twenty none; nor has a record that stands still or is
// empty.
TEST(RipplePeriod, IsNoneInNoise) {
  for (unsigned seed = 11; seed <= 30; ++seed) {
    const Record r = record(5e-3, 0.0, seed);
    EXPECT_EQ(ripple_period(r.travel, r.force), 0.0) << seed;
  }
  EXPECT_EQ(ripple_period({}, {}), 0.0);
  EXPECT_EQ(ripple_period(std::vector<double>(100, 0.1), std::vector<double>(100, 1.0)), 0.0);
}

}  // namespace
