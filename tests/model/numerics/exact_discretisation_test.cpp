#include "model/numerics/exact_discretisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using model::Block;
using model::Column;
using model::ExactDiscretisation;

/// φ_k(z) for a scalar in long double: the series below 1, the recursion φ_{k+1} = (φ_k − 1/k!)/z above.
long double phi(int k, long double z) {
  if (std::fabs(z) < 1.0L) {
    long double term = 1.0L, sum = 0.0L;
    for (int j = 1; j <= k; ++j) term /= static_cast<long double>(j);
    for (int j = 0; j < 40; ++j) {
      sum += term;
      term *= z / static_cast<long double>(k + j + 1);
    }
    return sum;
  }
  long double value = std::exp(z), factorial = 1.0L;
  for (int j = 0; j < k; ++j) {
    value = (value - 1.0L / factorial) / z;
    factorial *= static_cast<long double>(j + 1);
  }
  return value;
}

double scalar(double a, double h, int m) {
  const ExactDiscretisation<double, 1> step(Block<double, 1, 1>(a), h);
  return m < 0 ? step.transition()(0) : step.monomial(Column<double, 1>(1.0), m)(0);
}

// Point. A scalar has φ-functions in closed form: m! h φ_{m+1}(ah) for an input s^m. 1e-15 a doubling, at most 40 here;
// far below zero e^z is compared on the scale of 1.
TEST(ExactDiscretisation, HasThePhiFunctionsOfAScalar) {
  for (const double z : {0.0, 1e-9, -1e-3, 0.3, -0.5, -0.51, 1.0, -2.0, 5.0, -20.0, -1e3, -1e6}) {
    const double h = 0.01;
    EXPECT_NEAR(scalar(z / h, h, -1) / std::fmax(1.0, std::exp(z)),
                static_cast<double>(std::exp(static_cast<long double>(z))) / std::fmax(1.0, std::exp(z)), 2e-14)
        << "z " << z;
    double factorial = 1.0;
    for (int m = 0; m < 4; ++m) {
      const double exact = h * factorial * static_cast<double>(phi(m + 1, z));
      EXPECT_NEAR(scalar(z / h, h, m) / exact, 1.0, 1e-13) << "z " << z << ", input s^" << m;
      factorial *= m + 1;
    }
  }
}

// Point. A nilpotent matrix has finite series: A = [[0 1] [0 0]], an input s^m on the velocity. ẋ₂ = s^m gives
// x₂ = h/(m+1) and x₁ = h²/((m+1)(m+2)).
TEST(ExactDiscretisation, IntegratesADoubleIntegratorExactly) {
  Block<double, 2, 2> a;
  a << 0.0, 1.0, 0.0, 0.0;
  for (const double h : {1e-3, 0.25, 7.0}) {  // norms below and above the limit of the series
    const ExactDiscretisation<double, 2> step(a, h);
    EXPECT_DOUBLE_EQ(step.transition()(0, 1), h);
    EXPECT_DOUBLE_EQ(step.transition()(0, 0), 1.0);
    EXPECT_DOUBLE_EQ(step.transition()(1, 0), 0.0);
    for (int m = 0; m < 4; ++m) {
      const Column<double, 2> effect = step.monomial({0.0, 1.0}, m);
      EXPECT_NEAR(effect(1), h / (m + 1), 1e-15 * h);
      EXPECT_NEAR(effect(0), h * h / ((m + 1) * (m + 2)), 1e-15 * h * h);
    }
  }
}

// Point. An undamped oscillator turns: e^{Ah} = [[cos ωh, sin ωh/ω] [−ω sin ωh, cos ωh]], over less than a radian and
// over a thousand turns (each of the 14 doublings doubles the rounding of the angle: 6283 · 1e-15).
TEST(ExactDiscretisation, TurnsAnOscillatorByItsAngle) {
  const double omega = 50.0;
  Block<double, 2, 2> a;
  a << 0.0, 1.0, -omega * omega, 0.0;
  for (const double angle : {0.01, 1.0, 6283.0}) {
    const double h = angle / omega;
    const auto transition = ExactDiscretisation<double, 2>(a, h).transition();
    const double tolerance = 1e-14 * std::fmax(50.0, 4.0 * angle);
    EXPECT_NEAR(transition(0, 0), std::cos(angle), tolerance);
    EXPECT_NEAR(transition(0, 1) * omega, std::sin(angle), tolerance);
    EXPECT_NEAR(transition(1, 0) / omega, -std::sin(angle), tolerance);
    EXPECT_NEAR(transition(1, 1), std::cos(angle), tolerance);
  }
}

// Law. Two steps of h are one of 2h, also with inputs: what an input does in the first half is carried on.
TEST(ExactDiscretisation, JoinsTwoStepsIntoOne) {
  Block<double, 3, 3> a;
  a << -1.0, 20.0, 3.0, -40.0, -2.0, 0.5, 7.0, 0.0, -300.0;
  const Column<double, 3> b(1.0, -2.0, 5.0);
  const ExactDiscretisation<double, 3> half(a, 0.02), whole(a, 0.04);
  EXPECT_LT((half.transition() * half.transition() - whole.transition()).norm(), 1e-13);
  const Column<double, 3> joined = half.transition() * half.held(b) + half.held(b);
  EXPECT_LT((joined - whole.held(b)).norm(), 1e-13 * whole.held(b).norm());
}

// Law. Stiff to the limit: a mode of −1e12 1/s beside one of −1 1/s leaves the slow one alone and settles at −B u/λ.
TEST(ExactDiscretisation, IsStableAndExactForHugeStiffness) {
  Block<double, 2, 2> a = Block<double, 2, 2>::Zero();
  a(0, 0) = -1e9;
  a(1, 1) = -1.0;
  const ExactDiscretisation<double, 2> step(a, 1.0);
  EXPECT_NEAR(step.transition()(1, 1), std::exp(-1.0), 1e-8);  // −1 is 1e-9 of the norm: 30 doublings from 1 − 1e-9
  EXPECT_EQ(step.transition()(0, 0), 0.0);
  EXPECT_NEAR(step.held({1.0, 0.0})(0), 1e-9, 1e-16);
}

// Point. An input that goes straight from u₀ to u₁, into a pure integrator: the trapezium.
TEST(ExactDiscretisation, WeighsAStraightInputByTheTrapezium) {
  const ExactDiscretisation<double, 1> step(Block<double, 1, 1>(0.0), 0.2);
  const auto columns = step.straight(Column<double, 1>(3.0));
  EXPECT_DOUBLE_EQ(columns(0), 0.3);
  EXPECT_DOUBLE_EQ(columns(1), 0.3);
}

// Point. Hermite input into a pure integrator, by value: h/2 (x₀ + x₁) + h²/12 (ẋ₀ − ẋ₁); by rate: x₁ − x₀.
TEST(ExactDiscretisation, WeighsAHermiteInputAsItsIntegral) {
  const double h = 0.2;
  const ExactDiscretisation<double, 1> step(Block<double, 1, 1>(0.0), h);
  const auto value = step.hermite(Column<double, 1>(1.0), Column<double, 1>(0.0));
  EXPECT_NEAR(value(0), h / 2, 1e-16);
  EXPECT_NEAR(value(1), h * h / 12, 1e-16);
  EXPECT_NEAR(value(2), h / 2, 1e-16);
  EXPECT_NEAR(value(3), -h * h / 12, 1e-16);
  const auto rate = step.hermite(Column<double, 1>(0.0), Column<double, 1>(1.0));
  EXPECT_NEAR(rate(0), -1.0, 1e-15);
  EXPECT_NEAR(rate(1), 0.0, 1e-15);
  EXPECT_NEAR(rate(2), 1.0, 1e-15);
  EXPECT_NEAR(rate(3), 0.0, 1e-15);
}

// Point. Into a pure integrator the continued input has the weights of Adams and Bashforth.
TEST(ExactDiscretisation, ContinuesAnInputWithTheWeightsOfAdamsAndBashforth) {
  const double h = 0.5;
  const ExactDiscretisation<double, 1> step(Block<double, 1, 1>(0.0), h);
  const auto third = step.continued<3>(Column<double, 1>(1.0));
  const std::vector<double> three{5.0 / 12.0, -16.0 / 12.0, 23.0 / 12.0};
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(third(k), h * three[static_cast<std::size_t>(k)], 1e-15);
  const auto fourth = step.continued<4>(Column<double, 1>(1.0));
  const std::vector<double> four{-9.0 / 24.0, 37.0 / 24.0, -59.0 / 24.0, 55.0 / 24.0};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(fourth(k), h * four[static_cast<std::size_t>(k)], 1e-15);
}

// Law. With dynamics the weights are exact for every input that is a polynomial through the samples: s², s³ there are
// 4, 8 … at the earlier samples, and the step must do what monomial() says.
TEST(ExactDiscretisation, ContinuesPolynomialsExactly) {
  Block<double, 2, 2> a;
  a << -3.0, 40.0, -90.0, -8.0;
  const ExactDiscretisation<double, 2> step(a, 0.05);
  const Column<double, 2> b(2.0, -1.0);
  const auto check = [&](const auto& columns, int order) {
    for (int m = 0; m < order; ++m) {
      Column<double, 2> sum = Column<double, 2>::Zero();
      for (int k = 0; k < order; ++k) sum += columns.col(k) * std::pow(k - order + 1.0, m);
      EXPECT_LT((sum - step.monomial(b, m)).norm(), 1e-15) << "s^" << m << " by order " << order;
    }
  };
  check(step.continued<3>(b), 3);
  check(step.continued<4>(b), 4);
}

// Fault. No matrix of a rig may be without a finite step: it stops where it is built, not later in the loop.
TEST(ExactDiscretisationDeathTest, StopsAtWhatHasNoStep) {
  const auto build = [](double a, double h) { const ExactDiscretisation<double, 1> step(Block<double, 1, 1>(a), h); };
  EXPECT_DEATH(build(-1.0, 0.0), "");
  EXPECT_DEATH(build(-1.0, -1.0), "");
  EXPECT_DEATH(build(std::nan(""), 1.0), "");
  EXPECT_DEATH(build(1e300, 1e10), "");
}

}  // namespace
