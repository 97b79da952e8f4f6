// Fewer samples without folding.
#include "host_sim/identification/noise/decimation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace decimation_test {
namespace {

using namespace host_sim;

constexpr double period = 1e-3;

// Law. Up to the highest frequency of interest a sine keeps its amplitude; one that would be folded there is gone.
TEST(Decimation, KeepsWhatMattersAndFoldsNothing) {
  const identification::Decimation decimation(1000.0, 90.0);
  ASSERT_EQ(decimation.factor(), 4U);
  for (const double f : {0.0, 10.0, 89.0, 161.0, 255.0, 337.0, 420.0}) {
    std::vector<double> cosine(4000);
    for (std::size_t k = 0; k < cosine.size(); ++k) {
      cosine[k] = std::cos(2.0 * std::numbers::pi * f * period * static_cast<double>(k));
    }
    const auto fewer = decimation(cosine);
    ASSERT_EQ(fewer.size(), 1000U);
    for (std::size_t k = 50; k < 950; ++k) {  // zeros around the signal are 38 samples away at most
      EXPECT_NEAR(fewer[k], f < 90.0 ? cosine[4 * k] : 0.0, 2.0 * identification::Decimation::ripple)
          << f << " Hz, " << k;
    }
  }
}

// At a low sample rate nothing is dropped.
TEST(Decimation, LeavesSlowRecordingsAlone) {
  const identification::Decimation decimation(400.0, 90.0);
  EXPECT_EQ(decimation.factor(), 1U);
  EXPECT_EQ(decimation({1.0, -2.0, 3.0}), (std::vector<double>{1.0, -2.0, 3.0}));
}

}  // namespace
}  // namespace decimation_test
