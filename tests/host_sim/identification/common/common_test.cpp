// What all steps share: work on several threads, bands, words.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/common/wording.hpp"

namespace {

using namespace host_sim::identification;

// Law. Each index is worked on once, also by work inside of work; what is thrown arrives.
TEST(ForAll, WorksOnEachIndexOnce) {
  std::vector<int> count(100, 0);
  for_all(10, [&](std::size_t i) { for_all(10, [&](std::size_t j) { ++count[10 * i + j]; }); });
  for (const int c : count) EXPECT_EQ(c, 1);
  EXPECT_THROW(for_all(8,
                       [](std::size_t i) {
                         if (i == 5) throw std::runtime_error("5");
                       }),
               std::runtime_error);
}

// Point. Lower edges belong to their band; what lies beyond the last edge to none.
TEST(FrequencyBands, BeginAtTheirLowerEdge) {
  EXPECT_EQ(noise_band_of(0.0), 0U);
  EXPECT_EQ(noise_band_of(0.5), 1U);
  EXPECT_EQ(noise_band_of(89.9), noise_bands - 1);
  EXPECT_EQ(noise_band_of(90.0), noise_bands);
}

// Point. 250 of power in 200 residuals of variance 1: 50 too much, of a standard deviation of √400 = 20.
TEST(FrequencyBands, CountPowerInStandardDeviations) {
  const Power power{250.0, 200.0};
  EXPECT_DOUBLE_EQ(power.ratio(), 1.25);
  EXPECT_DOUBLE_EQ(power.excess(), 50.0);
  EXPECT_DOUBLE_EQ(power.significance(), 2.5);
  EXPECT_EQ(Power{}.significance(), 0.0);
}

TEST(Wording, NamesEffectsAndJoinsThem) {
  EXPECT_EQ(words({firmware::find_effect("sensor_lag"), model::Channel::F, {1e-3}}), "sensor_lag of F");
  EXPECT_EQ(words({firmware::find_effect("bump_stop"), std::nullopt, {}}), "bump_stop");
  EXPECT_EQ(joined({"a"}), "a");
  EXPECT_EQ(joined({"a", "b", "c"}), "a, b and c");
}

}  // namespace
