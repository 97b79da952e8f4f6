#include "firmware/loop/reference/ramp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace ramp_test {
namespace {

using firmware::Ramps;
using firmware::ReturnToRest;
using firmware::SmoothMove;

constexpr double h = 1e-3;

template <class Move>
std::vector<hal::Command> all_of(Move& move, std::size_t most = 100'000) {
  std::vector<hal::Command> commands;
  while (!move.arrived() && commands.size() < most) commands.push_back(move.next());
  return commands;
}

// Point. (1) by hand: 1 cm at 0.05 m/s takes T = 0.3 s; a quarter of the way in time is 10/64 of the way in space, the
// speed there is 6·¼·¾ way/T.
TEST(SmoothMove, IsEquationOne) {
  SmoothMove move(0.0, 0.01, 0.05, h);
  const auto commands = all_of(move);
  ASSERT_EQ(commands.size(), 300U);
  EXPECT_NEAR(commands[74].position, 0.01 * 10.0 / 64.0, 1e-15);
  EXPECT_NEAR(commands[74].velocity, 6.0 * 0.25 * 0.75 * 0.01 / 0.3, 1e-14);
  EXPECT_NEAR(commands[74].acceleration, (6.0 - 3.0) * 0.01 / (0.3 * 0.3), 1e-12);
  EXPECT_EQ(commands.back(), (hal::Command{0.01, 0.0, 0.0})) << "exactly there, at rest";
}

// Law. The rate is the highest speed, whatever way and direction; rounding the time up may only make it slower.
TEST(SmoothMove, NeverExceedsItsRate) {
  for (const double to : {0.1, -0.1, 1e-4, 0.0333}) {
    SmoothMove move(0.02, to, 0.05, h);
    double last = 0.02, highest = 0.0;
    for (const hal::Command& c : all_of(move)) {
      highest = std::max(highest, std::abs(c.position - last) / h);
      last = c.position;
    }
    EXPECT_LE(highest, 0.05 * (1.0 + 1e-9)) << to;
    if (std::abs(to - 0.02) > 0.01) {
      EXPECT_GT(highest, 0.0498) << "and nearly reaches it: 300 periods and more";
    }
    EXPECT_EQ(move.next().position, to) << "stays";
  }
}

// Edge. A way that no time suffices for (a road in wrong units) is a move without end, not a count that overflows.
TEST(SmoothMove, OfAnEndlessWayNeverArrives) {
  for (const double rate : {0.05, 1e-300, 0.0}) {
    SmoothMove move(0.0, 1e300, rate, h);
    const hal::Command first = move.next();
    EXPECT_FALSE(move.arrived()) << rate;
    EXPECT_TRUE(std::isfinite(first.position)) << rate;
  }
}

TEST(SmoothMove, OfNoWayHasArrived) {
  SmoothMove move(0.01, 0.01, 0.05, h);
  EXPECT_TRUE(move.arrived());
  EXPECT_EQ(move.next(), (hal::Command{0.01, 0.0, 0.0}));
}

// Point. (2) by hand: from 0.4 m/s with 20 m/s² the stop takes 20 ms and 4 mm.
TEST(ReturnToRest, BrakesAsEquationTwo) {
  ReturnToRest way(0.01, 0.4, Ramps{}, 0.125, h);
  const auto commands = all_of(way);
  EXPECT_NEAR(commands[9].position, 0.01 + 0.4 * 0.01 - 0.5 * 20.0 * 0.01 * 0.01, 1e-15);
  EXPECT_NEAR(commands[9].velocity, 0.2, 1e-14);
  EXPECT_EQ(commands[9].acceleration, -20.0);
  EXPECT_NEAR(commands[19].position, 0.014, 1e-15);
  EXPECT_NEAR(commands[19].velocity, 0.0, 1e-14);
  EXPECT_EQ(commands.back(), hal::Command{}) << "at rest in the rest position";
}

// Law. Wherever and however fast it begins, the way to rest stays in the stroke, is no faster than it began or than the
// rate, brakes no harder than asked unless the stroke is short, and has no jump.
TEST(ReturnToRest, StaysInsideStrokeAndSpeed) {
  const Ramps ramps{.rest = 0.03};
  for (const double position : {-0.125, -0.12, 0.0, 0.03, 0.1, 0.1249}) {
    for (const double velocity : {-0.7, -0.01, 0.0, 1e-6, 0.3, 0.7}) {
      ReturnToRest way(position, velocity, ramps, 0.125, h);
      const double left = velocity > 0.0 ? 0.125 - position : 0.125 + position;
      const double allowed = left > 0.0 ? std::max(20.0, velocity * velocity / (2.0 * left)) : 0.0;
      double last = position, last_velocity = velocity;
      for (const hal::Command& c : all_of(way)) {
        ASSERT_LE(std::abs(c.position), 0.125) << position << " " << velocity;
        const double v = (c.position - last) / h;
        ASSERT_LE(std::abs(v), std::max(std::abs(velocity), ramps.rate) * (1.0 + 1e-9)) << position << " " << velocity;
        // From mean speed to mean speed of two periods; 20 m/s² more where braking ends within one and the move begins.
        if (left > 0.0) {
          ASSERT_LE(std::abs(v - last_velocity) / h, allowed + 21.0) << position << " " << velocity;
        }
        last = c.position;
        last_velocity = v;
      }
      ASSERT_TRUE(way.arrived());
      EXPECT_EQ(last, 0.03) << position << " " << velocity;
    }
  }
}

// Rounding must not carry the end of a braking beyond the stroke either: gentle brakes, so that all the way left is
// used.
TEST(ReturnToRest, NeverRoundsBeyondTheStroke) {
  constexpr unsigned seed = 1;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const double left = 0.25 * share(random);
    ReturnToRest way(side * (0.125 - left), side * (0.45 + 0.25 * share(random)), Ramps{.braking = 1e-3}, 0.125, h);
    double farthest = -1.0;
    for (int k = 0; k < 1200; ++k) farthest = std::max(farthest, side * way.next().position);
    ASSERT_LE(farthest, 0.125) << "seed " << seed << ", case " << i;
    ASSERT_GT(farthest, 0.125 - 1e-6) << "seed " << seed << ", case " << i;
  }
}

// Against the stop with no way left there is only one command that does not leave the stroke.
TEST(ReturnToRest, StopsDeadAtTheEndOfTheStroke) {
  ReturnToRest way(0.125, 0.7, Ramps{}, 0.125, h);
  EXPECT_LE(way.next().position, 0.125);
}

}  // namespace
}  // namespace ramp_test
