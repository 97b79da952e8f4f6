#include "firmware/loop/guards/command_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace command_guard_test {
namespace {

using firmware::CommandGuard;
using firmware::Limits;
using firmware::Reason;

constexpr double h = 1e-3;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Every limit but that of acceleration.
Limits any_acceleration() {
  Limits limits;
  limits.acceleration = firmware::never_reached;
  return limits;
}

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
  CommandGuard guard(any_acceleration(), h, 0.0);
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
    CommandGuard guard(any_acceleration(), h, 0.0);
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

// Law. A command that is slowed down has the acceleration of its positions: an acceleration sensor of a foot point that
// follows does not contradict them.
TEST(CommandGuard, SlowerCommandsHaveTheAccelerationOfTheirPositions) {
  CommandGuard guard(Limits{}, h, 0.0);
  double last = 0.0, velocity = 0.0;
  bool was_limited = false;
  for (int k = 1; k <= 40; ++k) {
    const double t = k * h, wanted = 0.9, rise = 60.0;  // [m/s], [m/s²]: beyond 0.7 m/s after 12 ms
    const double speed = std::min(wanted, rise * t);
    const double position = speed < wanted ? 0.5 * rise * t * t : wanted * t - 0.5 * wanted * wanted / rise;
    const auto verdict = guard.judge({position, speed, speed < wanted ? rise : 0.0});
    const double moved = (verdict.command.position - last) / h;
    if (verdict.limited && was_limited) {
      EXPECT_NEAR(verdict.command.acceleration, (moved - velocity) / h, 1e-6) << k;
    }
    was_limited = verdict.limited;
    guard.passed(verdict.command);
    last = verdict.command.position;
    velocity = moved;
  }
  EXPECT_GT(guard.limited_count(), 5U);
}

// 50 ms of limiting are allowed, the 51st period in a row trips; a period that needs no limiting begins anew.
TEST(CommandGuard, TripsWhenLimitedForTooLong) {
  CommandGuard guard(any_acceleration(), h, -0.1);
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
  CommandGuard guard(any_acceleration(), h, 0.0);
  for (const double side : {1.0, -1.0}) {
    const auto verdict = guard.judge({1e-4, 0.9 * side, 3.0});
    EXPECT_TRUE(verdict.limited);
    EXPECT_EQ(verdict.command, (hal::Command{1e-4, 0.7 * side, 0.0}));
  }
}

// The reason on record is the speed that was asked for, also where only the feed-forward was too fast.
TEST(CommandGuard, ReportsTheFeedForwardThatTripped) {
  CommandGuard guard(any_acceleration(), h, 0.0);
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

// The acceleration limit that comes with a speed limit is that of a sine of 30 Hz at that speed.
TEST(CommandGuard, DerivesItsAccelerationFromTheSpeed) {
  EXPECT_NEAR(Limits{}.highest_acceleration(), 2.0 * 3.14159265358979 * 30.0 * 0.7, 1e-9);
  Limits limits;
  limits.acceleration = 50.0;
  EXPECT_EQ(limits.highest_acceleration(), 50.0);
}

// A sine at just its acceleration goes out as it is, to the bit; 0.1 % more is limited.
TEST(CommandGuard, LetsTheAccelerationLimitPass) {
  const double w = 60.0, amplitude = 5e-3;
  for (const double share : {1.0, 0.999}) {
    Limits limits;
    limits.acceleration = share * amplitude * w * w;
    CommandGuard guard(limits, h, amplitude);
    for (int k = 1; k <= 5000; ++k) {
      const double cosine = std::cos(w * h * k);
      const hal::Command wanted{amplitude * cosine, -amplitude * w * std::sin(w * h * k), -amplitude * w * w * cosine};
      const auto verdict = guard.judge(wanted);
      ASSERT_FALSE(verdict.hazard) << k;
      if (share == 1.0) {
        ASSERT_EQ(verdict.command.position, wanted.position) << k;
        ASSERT_NEAR(verdict.command.acceleration, wanted.acceleration, 1e-9) << k;
      }
      guard.passed(verdict.command);
    }
    EXPECT_EQ(guard.limited_count() > 0, share < 1.0);
  }
}

// (1), (2): a step of 20 mm is a motion that keeps stroke, speed and acceleration, arrives without overshoot, and takes
// the time of that motion: the way at full speed and one acceleration time, 20/0.7 + 0.7/132 = 33.9 ms; (1) brakes by
// up to two periods earlier.
TEST(CommandGuard, AcceleratesAndBrakesWithinTheLimit) {
  const Limits limits;
  for (const double side : {1.0, -1.0}) {
    CommandGuard guard(limits, h, 0.0);
    double velocity = 0.0;
    int periods = 0;
    for (; guard.last().position != 20e-3 * side && periods < 100; ++periods) {
      const auto verdict = guard.judge({20e-3 * side, 0.0, 0.0});
      ASSERT_FALSE(verdict.hazard) << periods;
      const double now = (verdict.command.position - guard.last().position) / h;
      EXPECT_LE(std::abs(now), limits.speed * (1.0 + 1e-9));
      EXPECT_LE(std::abs(now - velocity), limits.highest_acceleration() * h * (1.0 + 1e-6)) << periods;
      EXPECT_LE(side * verdict.command.position, 20e-3 + 1e-12) << "no overshoot";
      velocity = now;
      guard.passed(verdict.command);
    }
    EXPECT_NEAR(periods, 34, 4);
  }
}

// A jump onto a moving reference meets it at its own speed.
TEST(CommandGuard, CatchesUpWithAMovingReference) {
  CommandGuard guard(Limits{}, h, 0.0);
  for (int k = 1; k <= 60; ++k) {
    const double wanted = 10e-3 + 0.3 * h * k;
    const auto verdict = guard.judge({wanted, 0.3, 0.0});
    ASSERT_FALSE(verdict.hazard) << k;
    EXPECT_LE(verdict.command.position, wanted + 1e-12) << k;
    guard.passed(verdict.command);
    if (k > 45) {
      EXPECT_EQ(verdict.command.position, wanted) << k;
    }
  }
}

// (3): a reference that was too fast for 20 ms turns round while it is caught up with, as the deflection of a hil rig
// on a rough road does. Braked as if the reference moved straight on, the command overshot by 2.1 mm, was limited for
// 52 ms, and the run ended.
TEST(CommandGuard, CatchesUpWithAReferenceThatTurnsRound) {
  Limits limits;
  limits.speed = 1.5;
  constexpr double fast = 2.2, back = 1.4, w = 2.0 * 3.14159265358979 * 12.0;  // [m/s], [m/s], [1/s]
  constexpr double there = fast / w, acceleration = fast * w, w_back = acceleration / back, here = back / w_back;
  CommandGuard guard(limits, h, -there);
  double overshoot = 0.0;
  for (int k = 1; k <= 68; ++k) {
    const double t = h * k, s = t - 3.14159265358979 / w;
    const hal::Command wanted =
        s < 0.0 ? hal::Command{-there * std::cos(w * t), fast * std::sin(w * t), acceleration * std::cos(w * t)}
                : hal::Command{there - here + here * std::cos(w_back * s), -back * std::sin(w_back * s),
                               -acceleration * std::cos(w_back * s)};
    const auto verdict = guard.judge(wanted);
    ASSERT_FALSE(verdict.hazard) << k;
    overshoot = std::max(overshoot, verdict.command.position - wanted.position);
    guard.passed(verdict.command);
  }
  EXPECT_GT(guard.limited_count(), 30U);
  EXPECT_LT(overshoot, 0.1e-3);
}

// A zigzag between ± 0.6 m/s, 1200 m/s² at each corner, is below the speed limit. It was not noticed.
TEST(CommandGuard, TripsOnAZigzag) {
  CommandGuard guard(Limits{}, h, 0.0);
  std::optional<firmware::Trip> hazard;
  int k = 1;
  for (; k < 1000 && !hazard; ++k) {
    const bool up = k % 2 == 1;
    const auto verdict = guard.judge({up ? 0.6e-3 : 0.0, up ? 0.6 : -0.6, 0.0});
    hazard = verdict.hazard;
    guard.passed(verdict.command);
  }
  ASSERT_TRUE(hazard);
  EXPECT_EQ(hazard->reason, Reason::acceleration);
  EXPECT_NEAR(hazard->limit, 131.9, 0.1);
  EXPECT_GT(std::abs(hazard->value), hazard->limit);
  EXPECT_LE(k, 60) << "50 ms";
}

// A reference that turns round so late that the acceleration limit cannot brake before the end of the stroke.
TEST(CommandGuard, TripsBeforeItOvershootsTheStroke) {
  CommandGuard guard(Limits{}, h, 0.1);
  std::optional<firmware::Trip> hazard;
  for (int k = 1; k <= 80 && !hazard; ++k) {
    const double there = 0.1 + 0.6 * h * std::min(k, 41);
    const auto verdict = guard.judge({there, k <= 41 ? 0.6 : 0.0, 0.0});
    hazard = verdict.hazard;
    if (!hazard) {
      EXPECT_LE(verdict.command.position, 0.125);
      guard.passed(verdict.command);
    }
  }
  ASSERT_TRUE(hazard);
  EXPECT_EQ(hazard->reason, Reason::stroke);
}

// A drive that takes feed-forward does not see more than the limit.
TEST(CommandGuard, CutsFeedForwardAcceleration) {
  Limits limits;
  limits.acceleration = 10.0;
  CommandGuard guard(limits, h, 0.0);
  const auto verdict = guard.judge({0.0, 0.0, -33.0});
  EXPECT_FALSE(verdict.limited);
  EXPECT_EQ(verdict.command.acceleration, -10.0);
}

}  // namespace
}  // namespace command_guard_test
