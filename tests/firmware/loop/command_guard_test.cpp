#include "firmware/loop/command_guard.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace {

using firmware::CommandGuard;
using firmware::Limits;
using firmware::Reason;

constexpr double h = 1e-3;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Beyond the stroke is where steel meets steel: at once, in both directions, and the command does not pass.
TEST(CommandGuard, TripsBeyondTheStroke) {
  for (const double side : {1.0, -1.0}) {
    CommandGuard guard(Limits{}, h, 0.1249 * side);
    EXPECT_FALSE(guard.judge({0.125 * side, 0.0, 0.0}).hazard);
    const auto verdict = guard.judge({0.12501 * side, 0.0, 0.0});
    ASSERT_TRUE(verdict.hazard);
    EXPECT_EQ(verdict.hazard->reason, Reason::stroke);
    EXPECT_EQ(verdict.hazard->value, 0.12501 * side);
    EXPECT_EQ(verdict.hazard->limit, 0.125);
  }
}

TEST(CommandGuard, TripsOnWhatIsNoNumber) {
  CommandGuard guard(Limits{}, h, 0.0);
  for (const hal::Command& bad :
       {hal::Command{nan, 0.0, 0.0}, hal::Command{0.0, nan, 0.0}, hal::Command{0.0, 0.0, nan}}) {
    const auto verdict = guard.judge(bad);
    ASSERT_TRUE(verdict.hazard);
    EXPECT_EQ(verdict.hazard->reason, Reason::command_not_finite);
  }
}

// A motion at exactly the limit is allowed: rounding of positions must not count as speed.
TEST(CommandGuard, LetsTheLimitItselfPass) {
  CommandGuard guard(Limits{}, h, 0.0);
  for (int k = 1; k <= 150; ++k) {
    const hal::Command wanted{0.7 * h * k, 0.7, 0.0};
    const auto verdict = guard.judge(wanted);
    EXPECT_FALSE(verdict.limited) << k;
    EXPECT_EQ(verdict.command, wanted);
    guard.passed(verdict.command);
  }
  EXPECT_EQ(guard.limited_count(), 0U);
}

// A jump is followed as fast as allowed, and caught up with: 4.2 mm take 6 periods at 0.7 mm each.
TEST(CommandGuard, LimitsAJumpAndCatchesUp) {
  for (const double side : {1.0, -1.0}) {
    CommandGuard guard(Limits{}, h, 0.0);
    double last = 0.0;
    int periods = 0;
    while (last != 4.2e-3 * side && periods < 100) {
      const auto verdict = guard.judge({4.2e-3 * side, 0.0, 5.0});
      ASSERT_FALSE(verdict.hazard);
      EXPECT_LE(std::abs(verdict.command.position - last), 0.7e-3 * (1.0 + 1e-9));
      if (verdict.limited) {
        EXPECT_EQ(verdict.command.velocity, 0.7 * side);
        EXPECT_EQ(verdict.command.acceleration, 0.0);
      }
      guard.passed(verdict.command);
      last = verdict.command.position;
      ++periods;
    }
    EXPECT_EQ(periods, 6);
    EXPECT_EQ(guard.limited_count(), 5U) << "the last period is not faster than allowed";
  }
}

// 50 ms of limiting are allowed, the 51st period in a row trips; a period that needs no limiting begins anew.
TEST(CommandGuard, TripsWhenLimitedForTooLong) {
  CommandGuard guard(Limits{}, h, -0.1);
  const hal::Command far{0.1, 0.0, 0.0};
  for (int k = 1; k <= 50; ++k) {
    const auto verdict = guard.judge(far);
    ASSERT_FALSE(verdict.hazard) << k;
    guard.passed(verdict.command);
  }
  const auto pause = guard.judge(guard.last());
  EXPECT_FALSE(pause.limited);
  guard.passed(pause.command);
  for (int k = 1; k <= 50; ++k) {
    const auto verdict = guard.judge(far);
    ASSERT_FALSE(verdict.hazard) << k;
    guard.passed(verdict.command);
  }
  const double last = guard.last().position;
  const auto verdict = guard.judge(far);
  ASSERT_TRUE(verdict.hazard);
  EXPECT_EQ(verdict.hazard->reason, Reason::speed);
  EXPECT_EQ(verdict.hazard->limit, 0.7);
  EXPECT_DOUBLE_EQ(verdict.hazard->value, (0.1 - last) / h);
}

// A drive that takes feed-forward would follow a velocity that is too high even where the positions are tame.
TEST(CommandGuard, LimitsFeedForwardVelocity) {
  CommandGuard guard(Limits{}, h, 0.0);
  for (const double side : {1.0, -1.0}) {
    const auto verdict = guard.judge({1e-4, 0.9 * side, 3.0});
    EXPECT_TRUE(verdict.limited);
    EXPECT_EQ(verdict.command, (hal::Command{1e-4, 0.7 * side, 0.0}));
  }
}

// The reason on record is the speed that was asked for, also where only the feed-forward was too fast.
TEST(CommandGuard, ReportsTheFeedForwardThatTripped) {
  CommandGuard guard(Limits{}, h, 0.0);
  for (int k = 1; k <= 50; ++k) EXPECT_FALSE(guard.judge({0.0, -0.9, 0.0}).hazard);
  const auto verdict = guard.judge({0.0, -0.9, 0.0});
  ASSERT_TRUE(verdict.hazard);
  EXPECT_EQ(verdict.hazard->reason, Reason::speed);
  EXPECT_EQ(verdict.hazard->value, -0.9);
}

TEST(CommandGuard, KnowsHowFastTheLastCommandMoved) {
  CommandGuard guard(Limits{}, h, 0.0);
  guard.passed({1e-4, 55.0, 0.0});
  guard.passed({3e-4, 55.0, 0.0});
  EXPECT_NEAR(guard.velocity(), 0.2, 1e-12) << "by positions, not by what feed-forward claims";
}

}  // namespace
