#include "host_sim/watch/envelope.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using host_sim::watch::Envelope;

// Law. A peak of one sample survives, however many samples there are.
TEST(WatchEnvelope, KeepsEachPeak) {
  Envelope envelope(0.005, 1000);
  envelope.begin({"F", "z_w"});
  for (int k = 0; k < 1000; ++k) {
    const double spike = k == 503 ? 900.0 : k == 777 ? -700.0 : 1.0;
    envelope.add((k + 0.5) * 1e-3, {{"F", spike}, {"other", 5.0}});
  }
  ASSERT_EQ(envelope.complete(), 199U);
  for (std::size_t i = 0; i < envelope.complete(); ++i) {
    EXPECT_EQ(envelope[i].index, static_cast<std::int64_t>(i));
    EXPECT_EQ(envelope[i].low[0], i == 155 ? -700.0 : 1.0);
    EXPECT_EQ(envelope[i].high[0], i == 100 ? 900.0 : 1.0);
    EXPECT_TRUE(std::isnan(envelope[i].low[1])) << "z_w was never there";
  }
}

TEST(WatchEnvelope, LeavesAGapAGapAndIsBounded) {
  Envelope envelope(0.01, 20);
  envelope.begin({"F"});
  for (int k = 0; k < 100; ++k) {
    if (k < 90 || k > 95) envelope.add((k + 0.5) * 0.01, {{"F", static_cast<double>(k)}});
  }
  ASSERT_EQ(envelope.complete(), 19U);
  EXPECT_EQ(envelope[0].index, 74);
  EXPECT_EQ(envelope[15].index, 89);
  EXPECT_EQ(envelope[16].index, 96);
}

TEST(WatchEnvelope, BeginsAnewWithTheClock) {
  Envelope envelope(0.01, 20);
  envelope.begin({"F"});
  envelope.add(-5.0, {{"F", 1.0}});
  envelope.add(7.0, {{"F", 1.0}});
  envelope.add(0.005, {{"F", 2.0}});
  envelope.add(0.015, {{"F", 3.0}});
  ASSERT_EQ(envelope.complete(), 1U);
  EXPECT_EQ(envelope[0].index, 0);
  EXPECT_EQ(envelope[0].high[0], 2.0);
  for (const double time : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    envelope.add(time, {{"F", 4.0}});
  }
  EXPECT_EQ(envelope.complete(), 1U) << "a time that no clock shows";
}

}  // namespace
