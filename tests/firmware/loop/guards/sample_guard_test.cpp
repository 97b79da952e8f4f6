#include "firmware/loop/guards/sample_guard.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace {

using firmware::Limits;
using firmware::Reason;
using firmware::SampleGuard;
using hal::Quality;
using model::Channel;

constexpr hal::Time ms = hal::milliseconds(1);

class Sensors final : public hal::SensorSource {
 public:
  explicit Sensors(const hal::SensorSetup& setup) : SensorSource(setup) {}

 private:
  hal::Result<hal::Frame> do_read() override { return hal::Fault::timeout; }
};

hal::SensorSetup two_channels() {
  hal::SensorSetup setup;
  setup[model::index(Channel::F)].fitted = true;
  setup[model::index(Channel::x_act)].fitted = true;
  return setup;
}

struct Guarded {
  Sensors sensors{two_channels()};
  SampleGuard guard{Limits{}, ms, sensors};
  int period = 0;

  /// One period in which F reads so, x_act well.
  void take(double force, Quality quality = Quality::good, hal::Time age = {}) {
    hal::Frame frame;
    const hal::Time now = ms * period++;
    frame.channels[model::index(Channel::F)] = {force, now - age, quality};
    frame.channels[model::index(Channel::x_act)] = {0.001, now, Quality::good};
    guard.take(frame, now);
  }
};

// Two bad ones are bridged with the last good value, the third trips; what kind of bad is kept apart.
TEST(SampleGuard, BridgesTwoBadSamplesAndTripsOnTheThird) {
  struct Case {
    Quality quality;
    Reason reason;
  };
  for (const Case& c : {Case{Quality::missing, Reason::sample_missing}, Case{Quality::clipped, Reason::sample_clipped},
                        Case{Quality::not_finite, Reason::sample_not_finite}}) {
    Guarded g;
    g.take(5.0);
    for (int bad = 1; bad <= 2; ++bad) {
      g.take(77.0, c.quality);
      EXPECT_FALSE(g.guard.hazard()) << bad;
      EXPECT_EQ(g.guard.value(Channel::F), 5.0);
      EXPECT_EQ(g.guard.bridged(), 1U << model::index(Channel::F));
    }
    g.take(78.0, c.quality);
    ASSERT_TRUE(g.guard.hazard());
    EXPECT_EQ(g.guard.hazard()->reason, c.reason);
    EXPECT_EQ(g.guard.hazard()->channel, Channel::F);
    EXPECT_EQ(g.guard.hazard()->value, 78.0);
    EXPECT_EQ(g.guard.hazard()->limit, 3.0);
    EXPECT_EQ(g.guard.hazard()->time, ms * 3);
    EXPECT_EQ(g.guard.bridged_count(), 3U);
  }
}

// Eight good ones make up for two bad ones at a leak of ¼.
TEST(SampleGuard, BeginsAnewAfterGoodSamples) {
  Guarded g;
  g.take(5.0);
  for (int k = 0; k < 100; ++k) {
    g.take(0.0, Quality::missing);
    g.take(0.0, Quality::missing);
    EXPECT_FALSE(g.guard.hazard());
    for (int good = 0; good < 8; ++good) g.take(6.0 + k);
    EXPECT_EQ(g.guard.value(Channel::F), 6.0 + k);
    EXPECT_EQ(g.guard.bridged(), 0U);
  }
}

// A sensor that loses one sample in five may go on, one that loses more for long may not: (2) and (3) by hand, one bad
// and three good ones add ¼ to the level, so the ninth bad sample fills it (1 + 8 · ¼ = 3); bad and good in turns add
// ¾, so the fourth does.
TEST(SampleGuard, TripsOnALastingShareOfBadSamples) {
  const auto trips_at = [](int good_between) {
    Guarded g;
    g.take(5.0);
    for (int bad = 1; bad <= 1000; ++bad) {
      g.take(0.0, Quality::missing);
      if (g.guard.hazard()) return bad;
      for (int good = 0; good < good_between; ++good) g.take(1.0 * good);
    }
    return 0;
  };
  EXPECT_EQ(trips_at(4), 0);
  EXPECT_EQ(trips_at(3), 9);
  EXPECT_EQ(trips_at(1), 4);
  EXPECT_EQ(trips_at(0), 3);
}

// There is nothing to bridge a first sample with: to invent a value would be to measure by guessing.
TEST(SampleGuard, NeverInventsAFirstValue) {
  Guarded g;
  g.take(0.0, Quality::missing);
  EXPECT_FALSE(g.guard.seen(Channel::F));
  ASSERT_TRUE(g.guard.hazard());
  EXPECT_EQ(g.guard.hazard()->reason, Reason::sample_missing);
  g.take(1.0);
  EXPECT_TRUE(g.guard.seen(Channel::F));
  EXPECT_FALSE(g.guard.hazard());
}

// Five periods old is still young enough, a nanosecond more is not; neither is a stamp from as far in the future.
TEST(SampleGuard, JudgesAgeExactly) {
  Guarded g;
  g.take(1.0);
  g.take(2.0, Quality::good, ms * 5);
  EXPECT_EQ(g.guard.value(Channel::F), 2.0);
  g.take(3.0, Quality::good, ms * 5 + hal::nanoseconds(1));
  EXPECT_EQ(g.guard.value(Channel::F), 2.0);
  g.take(4.0, Quality::good, ms * -5);
  EXPECT_EQ(g.guard.value(Channel::F), 4.0);
  g.take(5.0, Quality::good, ms * -5 - hal::nanoseconds(1));
  EXPECT_EQ(g.guard.value(Channel::F), 4.0);
  for (int k = 0; k < 2; ++k) g.take(6.0, Quality::good, ms * 6);
  ASSERT_TRUE(g.guard.hazard());
  EXPECT_EQ(g.guard.hazard()->reason, Reason::sample_stale);
}

// A frame that does not come is a missing sample of every channel; a source that is gone is a hazard by itself.
TEST(SampleGuard, KnowsLateFramesFromLostSensors) {
  Guarded g;
  g.take(5.0);
  g.guard.take(hal::Fault::timeout, ms * 1);
  EXPECT_FALSE(g.guard.hazard());
  EXPECT_EQ(g.guard.missed_frames(), 1U);
  EXPECT_EQ(g.guard.bridged_count(), 2U);
  EXPECT_EQ(g.guard.value(Channel::F), 5.0);
  g.guard.take(hal::Fault::disconnected, ms * 2);
  ASSERT_TRUE(g.guard.hazard());
  EXPECT_EQ(g.guard.hazard()->reason, Reason::sensors_lost);
}

TEST(SampleGuard, HoldsForcesAgainstTheirLimit) {
  for (const double side : {1.0, -1.0}) {
    Guarded g;
    g.take(25e3 * side);
    EXPECT_FALSE(g.guard.hazard());
    g.take(25.1e3 * side);
    ASSERT_TRUE(g.guard.hazard());
    EXPECT_EQ(g.guard.hazard()->reason, Reason::force);
    EXPECT_EQ(g.guard.hazard()->channel, Channel::F);
    EXPECT_EQ(g.guard.hazard()->value, 25.1e3 * side);
    EXPECT_EQ(g.guard.hazard()->limit, 25e3);
  }
}

// Displacements have no force limit, and a channel that is not fitted cannot be bad.
TEST(SampleGuard, LooksOnlyAtWhatIsFitted) {
  Guarded g;
  hal::Frame frame;
  frame.channels[model::index(Channel::F)] = {1.0, {}, Quality::good};
  frame.channels[model::index(Channel::x_act)] = {1e6, {}, Quality::good};
  frame.channels[model::index(Channel::F_w)] = {1e6, {}, Quality::good};
  g.guard.take(frame, {});
  EXPECT_FALSE(g.guard.hazard());
  EXPECT_EQ(g.guard.bridged(), 0U);
}

}  // namespace
