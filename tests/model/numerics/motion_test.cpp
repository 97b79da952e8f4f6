#include "model/numerics/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using model::Stroke;

// Point. The polynomial through (1, 2) and (3, −1), h = 0.5, at s = ¼: by hand
// 0.84375·1 + 0.140625·0.5·2 + 0.15625·3 + 0.046875·0.5 = 1.4765625.
TEST(Hermite, GoesThroughAPointCalculatedByHand) {
  const Stroke<double> from{1.0, 2.0}, to{3.0, -1.0};
  EXPECT_DOUBLE_EQ(hermite(from, to, 0.25, 0.5).position, 1.4765625);
  // velocity: 6s(1−s)(x₁−x₀)/h + (1−s)(1−3s)ẋ₀ + s(3s−2)ẋ₁ = 4.5 + 0.375 + 0.3125
  EXPECT_DOUBLE_EQ(hermite(from, to, 0.25, 0.5).velocity, 5.1875);
}

// Law. Both ends are kept, position and velocity, to the bit.
TEST(Hermite, KeepsBothEnds) {
  const Stroke<double> from{0.1, 0.3}, to{-0.7, 0.9};
  for (const double s : {0.0, 1.0}) {
    const auto at = hermite(from, to, s, 1e-3);
    EXPECT_EQ(at.position, s == 0.0 ? from.position : to.position);
    EXPECT_EQ(at.velocity, s == 0.0 ? from.velocity : to.velocity);
  }
}

// Law. The velocity is the derivative of the position: central difference, exact for a parabola, h²/24 x‴ off for a
// cubic.
TEST(Hermite, HasTheVelocityOfItsPosition) {
  const Stroke<double> from{1.0, 2.0}, to{3.0, -1.0};
  const double h = 0.5, ds = 1e-4;
  for (double s = 0.1; s < 1.0; s += 0.2) {
    const double difference =
        (hermite(from, to, s + ds, h).position - hermite(from, to, s - ds, h).position) / (2.0 * ds * h);
    EXPECT_NEAR(hermite(from, to, s, h).velocity, difference, 1e-6);
  }
}

// Order. Error h⁴/384 max|x⁗|, taken in the middle.
TEST(Hermite, MissesASineByAThreeHundredEightyFourthOfItsFourthDerivative) {
  for (const double h : {0.1, 0.05}) {
    const double t = 1.5;
    const Stroke<double> from{std::sin(t - h / 2), std::cos(t - h / 2)}, to{std::sin(t + h / 2), std::cos(t + h / 2)};
    const double error = hermite(from, to, 0.5, h).position - std::sin(t);
    EXPECT_NEAR(std::fabs(error) / (std::pow(h, 4) / 384.0 * std::sin(t)), 1.0, 0.01);
  }
}

// Point. The order in which the columns of a Hermite input take it.
TEST(Motion, ListsItsFactorsFromTheOldSampleToTheNew) {
  const auto factors = driven_by(model::Motion<double>{1.0, 2.0, 3.0}, Stroke<double>{4.0, 5.0});
  EXPECT_EQ(factors, (std::array{1.0, 2.0, 4.0, 5.0}));
}

}  // namespace
