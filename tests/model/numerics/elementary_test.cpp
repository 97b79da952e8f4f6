// Elementary functions of a step against those of the standard library.
#include "model/numerics/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

// Law. e^{−x}: eight squarings of 1 + O(ε) are right to 256 ε; exactly 1 at 0, exactly 0 far out.
TEST(Elementary, DecaysAsTheExponential) {
  for (double x = 1e-6; x < 63.0; x *= 1.3) EXPECT_NEAR(model::decaying(x) / std::exp(-x), 1.0, 6e-14) << x;
  EXPECT_EQ(model::decaying(0.0), 1.0);
  EXPECT_EQ(model::decaying(1e300), 0.0);
}

// Law. Sine and cosine of turns; c − 1 keeps its digits near 0. Two doublings: 4 ε, and ε |t| of a turn for the
// argument.
TEST(Elementary, TurnsAsSineAndCosine) {
  for (double t = -7.3; t < 7.3; t += 0.0137) {
    const auto turn = model::turned(t);
    EXPECT_NEAR(turn.sine, std::sin(2.0 * std::numbers::pi * t), 3e-14) << t;
    EXPECT_NEAR(turn.cosine_less_one, std::cos(2.0 * std::numbers::pi * t) - 1.0, 3e-14) << t;
  }
  const double angle = 2.0 * std::numbers::pi * 1e-7;
  EXPECT_NEAR(model::turned(1e-7).cosine_less_one / (-0.5 * angle * angle), 1.0, 1e-12);
  EXPECT_EQ(model::turned(3.0).sine, 0.0);
}

}  // namespace
