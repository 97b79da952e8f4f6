#include "host_sim/identification/parity/disturbed_span.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "host_sim/identification/prepare/prepared_recording.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using host_sim::identification::Balances;
using host_sim::identification::TimeSpan;
using model::Channel;

/// A push on the load cell, in units of its noise.
struct Push {
  std::size_t from, to;  ///< [ms]
  double size;
};

std::vector<TimeSpan> spans_of(const std::vector<Push>& pushes, const TimeSpan& within) {
  const firmware::RigDescription bench = sample::bench();
  firmware::Recording recording = sample::recorded(bench, 12.0);
  for (const Push& push : pushes) {
    for (std::size_t k = push.from; k < push.to; ++k) recording[Channel::F][k] += push.size * sample::force_noise;
  }
  const auto prepared = host_sim::identification::prepare_recording(bench, std::move(recording),
                                                                    host_sim::identification::Use::shared, false);
  return Balances(bench, prepared).disturbed(within);
}

// A block of 10 ms and the reach of the smooth window at either end.
void expect_span(const TimeSpan& span, double from, double to) {
  EXPECT_NEAR(span.from, from, 0.02);
  EXPECT_NEAR(span.to, to, 0.02);
}

TEST(DisturbedSpans, AreTheLoudestFirst) {
  const auto spans = spans_of({{3000, 3040, 60.0}, {5000, 5100, 100.0}}, {2.5, 6.0});
  ASSERT_EQ(spans.size(), 2U);
  expect_span(spans[0], 5.0, 5.1);
  expect_span(spans[1], 3.0, 3.04);
}

// 10 ms of 40 beside 100 ms of 100 are 0.016 of its power, below span_share.
TEST(DisturbedSpans, LeaveOutWhatIsSmallBesideTheLoudest) {
  const auto spans = spans_of({{3000, 3010, 40.0}, {5000, 5100, 100.0}}, {2.5, 6.0});
  ASSERT_EQ(spans.size(), 1U);
  expect_span(spans[0], 5.0, 5.1);
  EXPECT_EQ(spans_of({{3000, 3010, 40.0}}, {2.5, 6.0}).size(), 1U);
}

TEST(DisturbedSpans, LieInTheStretchThatIsAskedFor) {
  EXPECT_TRUE(spans_of({{5000, 5100, 100.0}}, {2.5, 4.5}).empty());
}

// span_gap: 0.1 s of quiet is one event, 0.2 s are two.
TEST(DisturbedSpans, JoinWhatIsATenthOfASecondApart) {
  EXPECT_EQ(spans_of({{5000, 5050, 100.0}, {5130, 5180, 100.0}}, {4.5, 6.0}).size(), 1U);
  EXPECT_EQ(spans_of({{5000, 5050, 100.0}, {5250, 5300, 100.0}}, {4.5, 6.0}).size(), 2U);
}

}  // namespace
