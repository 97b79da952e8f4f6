// Curves and surfaces through points.
#include "model/laws/curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "model/laws/surface.hpp"

namespace {

using Curve = model::Curve<double>;

Curve through(const std::vector<double>& x, const std::vector<double>& y) { return {x, y, x.size()}; }

// Point. s = 1, 3 and h = 1: d = 1, 6/(3/1 + 3/3) = 1.5, 3. f(0.5) = 0.5 (1 + 0.5 (3 − 2 − 1.5 + 0.5 (1 + 1.5 − 2)))
// = 0.4375; f(1.5) = 1 + 0.5 (1.5 + 0.5 (9 − 3 − 3 + 0.5 (1.5 + 3 − 6))) = 2.3125.
TEST(Curve, BetweenPointsIsTheCubicWorkedOutByHand) {
  const Curve f = through({0.0, 1.0, 2.0}, {0.0, 1.0, 4.0});
  EXPECT_DOUBLE_EQ(f(0.5), 0.4375);
  EXPECT_DOUBLE_EQ(f(1.5), 2.3125);
  EXPECT_DOUBLE_EQ(f.slope(1.0), 1.5);
  EXPECT_DOUBLE_EQ(f(-2.0), -2.0) << "straight on with the first slope";
  EXPECT_DOUBLE_EQ(f(4.0), 10.0) << "straight on with the last slope";
}

// Point. With h = 1 and 2, s = 1 and 4: w₁ = 2·2 + 1 = 5, w₂ = 2 + 2·1 = 4, d = 9/(5/1 + 4/4) = 1.5.
TEST(Curve, SlopeBetweenUnequalIntervalsIsTheWeightedHarmonicMean) {
  EXPECT_DOUBLE_EQ(through({0.0, 1.0, 3.0}, {0.0, 1.0, 9.0}).slope(1.0), 1.5);
}

// Point. A simulation that diverges ends at no number, and reads nothing beyond the table (the sanitizers watch).
TEST(Curve, ReadsNothingBeyondItsTable) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const Curve f = through({0.0, 1.0, 2.0}, {0.0, 1.0, 4.0});
  std::uint8_t place = 0;
  for (const double x : {infinite, infinite, -infinite, -infinite, std::nan(""), infinite}) {
    EXPECT_FALSE(std::isfinite(f.near(x, place)));
    EXPECT_FALSE(std::isfinite(f(x)));
  }
  EXPECT_DOUBLE_EQ(f.near(0.5, place), 0.4375) << "and finds back";
}

// Law. where(y, κ) solves f(x) + κ x = y, in a table and beyond, for a soft κ and a stiff one, also where f is level.
TEST(Curve, FindsWhereItsSumWithALineHasAValue) {
  const Curve f = through({-1.0, -0.1, 0.0, 0.02, 0.5, 1.0}, {-900.0, -700.0, 0.0, 600.0, 600.0, 1500.0});
  for (const double kappa : {1.0, 126.0, 1e4, 1e9}) {
    for (double x = -3.0; x < 3.0; x += 0.0137) {
      const double y = f(x) + kappa * x;
      EXPECT_NEAR(y - kappa * f.where(y, kappa), f(x), 1e-4 * 700.0 + 1e-15 * std::abs(y)) << kappa << ", " << x;
    }
  }
}

// Law. For every number of points: it passes through each of them, and its slope has no jump there.
TEST(Curve, PassesThroughEachPointWithoutAKink) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> step(0.01, 1.0), height(-3.0, 3.0);
  for (std::size_t n = 2; n <= model::curve_points; ++n) {
    std::vector<double> x{-2.0}, y{1.0};
    while (x.size() < n) {
      x.push_back(x.back() + step(random));
      y.push_back(height(random));
    }
    const Curve f = through(x, y);
    for (std::size_t i = 0; i < n; ++i) {
      const double beside = 1e-9;
      EXPECT_DOUBLE_EQ(f(x[i]), y[i]);
      EXPECT_NEAR(f(x[i] - beside), y[i], beside * f.steepest() * 1.01) << n << " points, point " << i;
      EXPECT_NEAR(f.slope(x[i] - beside), f.slope(x[i]), 1e-3 * f.steepest()) << n << " points, point " << i;
    }
  }
}

// Law. Where the points ascend the curve does, and it stays between its neighbours. steepest() bounds its slope.
TEST(Curve, IsMonotoneWhereItsPointsAre) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> exponent(-4.0, 1.0);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> x{0.0}, y{0.0};
    while (x.size() < model::curve_points) {
      x.push_back(x.back() + std::pow(10.0, exponent(random)));
      y.push_back(y.back() + (round % 3 == 0 && x.size() % 4 == 0 ? 0.0 : std::pow(10.0, exponent(random))));
    }
    const Curve f = through(x, y);
    double before = f(-1.0);
    for (int k = 1; k <= 4000; ++k) {
      const double at = -1.0 + k * (x.back() + 2.0) / 4000.0, now = f(at);
      ASSERT_GE(now, before - 1e-12 * y.back()) << "round " << round << ", x = " << at;
      ASSERT_LE(std::abs(f.slope(at)), f.steepest() * (1.0 + 1e-12));
      before = now;
    }
  }
}

// Limit. A smooth law sampled at 9, 17, 33 points: the error falls by 2³ at least, from twice to twice as many.
TEST(Curve, ApproachesTheMeasuredLawWithMorePoints) {
  const auto law = [](double v) { return 1500.0 * v / std::sqrt(0.09 + v * v); };
  const auto error = [&](std::size_t n) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < n; ++i) {
      x.push_back(-1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(n - 1));
      y.push_back(law(x.back()));
    }
    const Curve f = through(x, y);
    double worst = 0.0;
    for (double v = -0.7; v <= 0.7; v += 1e-3) worst = std::max(worst, std::abs(f(v) - law(v)));
    return worst;
  };
  EXPECT_LT(error(17), error(9) / 4.0);
  EXPECT_LT(error(33), error(17) / 4.0);
  EXPECT_LT(error(33), 3.0) << "N, of 1500";
}

model::SurfaceTable<double> surface(std::size_t rows, std::size_t columns, double (*f)(double, double)) {
  model::SurfaceTable<double> table{.rows = static_cast<std::uint8_t>(rows),
                                    .columns = static_cast<std::uint8_t>(columns)};
  for (std::size_t i = 0; i < rows; ++i) table.deflection[i] = -0.1 + 0.03 * static_cast<double>(i);
  for (std::size_t j = 0; j < columns; ++j) table.velocity[j] = -1.0 + 0.2 * static_cast<double>(j);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) table.value[i][j] = f(table.deflection[i], table.velocity[j]);
  }
  return table;
}

// Law. A twisted plane a x + b v + c x v is reproduced everywhere, beyond the table, too, and so are its slopes.
TEST(Surface, ReproducesATwistedPlane) {
  const auto plane = [](double x, double v) { return 3e4 * x + 1500.0 * v + 2e3 * x * v; };
  for (const auto& [rows, columns] : {std::pair{2U, 2U}, {17U, 17U}, {3U, 11U}}) {
    const model::Surface<double> f(surface(rows, columns, plane));
    for (const double x : {-0.2, -0.1, -0.0999, 0.013, 0.2, 0.5}) {
      for (const double v : {-2.0, -0.31, 0.0, 0.8, 2.9}) {
        EXPECT_NEAR(f(x, v), plane(x, v), 1e-8) << x << ", " << v;
        EXPECT_NEAR(f.over_velocity(x, v), 1500.0 + 2e3 * x, 1e-8);
        EXPECT_NEAR(f.over_deflection(x, v), 3e4 + 2e3 * v, 1e-7);
      }
    }
  }
}

// Law. In a row it is the curve of that row; between rows the weighted mean of both.
TEST(Surface, IsTheCurveOfARowAndStraightBetween) {
  const auto table = surface(4, 9, [](double x, double v) { return (1.0 + 20.0 * x * x) * std::tanh(3.0 * v); });
  const model::Surface<double> f(table);
  const model::Curve<double> second(table.velocity, table.value[1], 9), third(table.velocity, table.value[2], 9);
  for (const double v : {-1.4, -0.33, 0.05, 0.5}) {
    EXPECT_NEAR(f(table.deflection[1], v), second(v), 1e-15);
    EXPECT_NEAR(f(0.75 * table.deflection[1] + 0.25 * table.deflection[2], v), 0.75 * second(v) + 0.25 * third(v),
                1e-14);
  }
}

}  // namespace
