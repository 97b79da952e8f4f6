// The delay equation: known roots, their proven number, and what is refused.
#include "host_sim/stability/roots/delay_equation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <numbers>
#include <random>

#include "host_sim/stability/margins/crossings.hpp"
#include "host_sim/stability/roots/characteristic_roots.hpp"
#include "host_sim/stability/roots/eigenvalues.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "model/rig/rig_model.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using namespace host_sim::stability;
using stability_tests::random_rig;
using stability_tests::Rig;

const Polynomial s_plus_0{0.0, 1.0};

// Point. f, f' and ∂f/∂τ against differences.
TEST(DelayEquation, HasTheDerivativesItSays) {
  const DelayEquation f({2.0, 0.3, 1.0}, {1.5, -0.4}, 0.7);
  const Complex s(-0.4, 1.9), h(1e-6, 0.0);
  EXPECT_LT(std::abs(f(s) - (2.0 + 0.3 * s + s * s + (1.5 - 0.4 * s) * std::exp(-0.7 * s))), 1e-14);
  const auto [value, slope] = f.jet(s);
  EXPECT_EQ(value, f(s));
  EXPECT_LT(std::abs(slope - (f(s + h) - f(s - h)) / 2e-6), 1e-8);
  DelayEquation later = f, earlier = f;
  later.set_delay(0.7 + 1e-6);
  earlier.set_delay(0.7 - 1e-6);
  EXPECT_LT(std::abs(f.by_delay(s) - (later(s) - earlier(s)) / 2e-6), 1e-8);
}

// Point. s + e^{−s} has its roots at the branches of Lambert's W(−1).
TEST(DelayEquation, CountsAndFindsTheBranchesOfLambertsFunction) {
  const DelayEquation f(s_plus_0, {1.0}, 1.0);
  const Complex first(-0.31813150520476413, 1.3372357014306895), second(-2.0622777295982838, 7.5886311784725127);
  EXPECT_EQ(f.roots_right_of(0.0), 0);
  EXPECT_EQ(f.roots_right_of(-0.3), 0);
  EXPECT_EQ(f.roots_right_of(-0.35), 2);
  EXPECT_EQ(f.roots_right_of(-2.0), 2);
  EXPECT_EQ(f.roots_right_of(-2.1), 4);
  const RootSet set = characteristic_roots(f, -2.5);
  ASSERT_EQ(set.roots.size(), 2U);
  EXPECT_LT(std::abs(set.roots[0] - first), 1e-14);
  EXPECT_LT(std::abs(set.roots[1] - second), 1e-13);
}

// Point. A root counts as often as it is one: s + e^{−1} e^{−s} has the double root −1; a floating mass has s² = 0.
TEST(DelayEquation, CountsMultipleRoots) {
  const DelayEquation f(s_plus_0, {std::exp(-1.0)}, 1.0);
  EXPECT_EQ(f.roots_right_of(-1.1), 2);
  const RootSet set = characteristic_roots(f, -2.0);
  ASSERT_EQ(set.roots.size(), 2U);
  for (const Complex s : set.roots) EXPECT_NEAR(std::abs(s + 1.0), 0.0, 1e-7);  // √rounding: a double root is no better
  const RootSet floating = characteristic_roots(DelayEquation({0.0, 0.0, 2.0, 1.0}, {}, 0.0), -5.0);
  EXPECT_EQ(floating.count, 3);
  EXPECT_EQ(floating.roots.size(), 3U);
}

// Point. Roots just on this or that side of the line are told apart down to 1e-9; on the line there is no answer.
TEST(DelayEquation, TellsTheSidesOfTheLineApart) {
  const DelayEquation f(s_plus_0, {1.0}, 1.0);
  const double re = -0.31813150520476413;
  EXPECT_EQ(f.roots_right_of(re + 1e-9), 0);
  EXPECT_EQ(f.roots_right_of(re - 1e-9), 2);
  EXPECT_THROW(static_cast<void>(f.roots_right_of(re)), RootOnLine);
}

// Fault. A start that leads to no second pair leaves one root out: that must not pass.
TEST(CharacteristicRoots, ReportsARootThatWasNotFound) {
  const DelayEquation f(s_plus_0, {1.0}, 1.0);
  EXPECT_EQ(verified_roots(f, -2.1, {{-0.3, 1.3}, {-2.0, 7.6}}).count, 4);
  try {
    static_cast<void>(verified_roots(f, -2.1, {{-0.3, 1.3}}));
    FAIL() << "two of four roots were taken for all";
  } catch (const CountMismatch& mismatch) {
    EXPECT_NE(std::string(mismatch.what()).find("2 characteristic roots found right of Re s = -2.1"),
              std::string::npos);
    EXPECT_NE(std::string(mismatch.what()).find("argument principle counts 4"), std::string::npos);
  }
  // One root twice is one root.
  EXPECT_THROW(static_cast<void>(verified_roots(f, -2.1, {{-0.3, 1.3}, {-0.31, 1.33}, {-0.32, -1.34}})), CountMismatch);
}

// Fault. Mass between force sensor and component: F = … + m ẍ delays the highest derivative. Refused with the reason.
TEST(DelayEquation, RefusesNeutralAndAdvancedLoops) {
  try {
    const DelayEquation neutral({1.0, 1.0, 2.0}, {1.0, 0.0, 0.5}, 0.01);
    FAIL();
  } catch (const UnfitLoop& reason) {
    EXPECT_NE(std::string(reason.what()).find("neutral with the ratio 0.25"), std::string::npos) << reason.what();
  }
  EXPECT_THROW(DelayEquation({1.0, 1.0}, {1.0, 0.0, 0.5}, 0.01), UnfitLoop);
}

// Law. P + Q e^{−sτ} from the model is the determinant of the physics document times the blocks' own denominators, on
// and off the axis, with every effect that has a linear part.
TEST(LinearRig, HasTheCharacteristicEquationWrittenByHand) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const Rig rig = random_rig(seed, seed % 2 == 0);
    const LinearRig linear = linearise(rig);
    const double delay = linear.delay();
    for (const Complex s : {Complex(0.0, 30.0), Complex(-5.0, 90.0), Complex(3.0, 8.0), Complex(-20.0, 250.0)}) {
      const Complex blocks =
          linear.machine.denominator()(s) * linear.component.denominator()(s) * linear.force_sensor.denominator()(s);
      const Complex by_hand = stability_tests::characteristic_by_hand(rig, s, delay);
      const Complex ours = linear.equation(delay)(s) / blocks;
      // A top mount is settled in 0.1 µs where the component has no damper: ω · 0.1 µs, with ω = 250 1/s.
      const double tolerance = rig.effects.get<model::TopMount>().active ? 5e-5 : 1e-10;
      EXPECT_LT(std::abs(ours - by_hand), tolerance * std::abs(by_hand)) << s;
    }
  }
}

/// Right-hand side of car and component as ẋ = A₀ x(t) + A₁ x(t − τ).
struct DelayedMatrices {
  Eigen::MatrixXd now, late;
};
DelayedMatrices matrices_of(const Rig& rig) {
  using Equations = model::RigEquations<double>;
  const Equations equations(linear_part(rig));
  // A piston that is locked or not there has two states that stand still and are no part of the loop.
  const int n = rig.has_fdva && rig.fdva.open_ducts > 0 ? 6 : 4;
  DelayedMatrices m{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  for (int j = 0; j < n; ++j) {
    const Equations::JoinedState unit = Equations::JoinedState::Unit(j);
    const Eigen::VectorXd joined = equations.joined(unit, {}, rig.has_fdva ? rig.fdva.open_ducts : 0).head(n);
    if (j < 4) {
      m.now.col(j).head(4) = equations.car(unit.head<4>(), {});
      m.late.col(j) = joined - m.now.col(j);
    } else {
      m.now.col(j) = joined;
    }
  }
  return m;
}

/// The generator of the whole delay system, states and their past, on Chebyshev points: no polynomial, no Newton.
std::vector<Complex> eigenvalues_of_generator(const DelayedMatrices& m, double tau, int nodes) {
  const Eigen::Index n = m.now.rows();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n * (nodes + 1), n * (nodes + 1));
  a.topLeftCorner(n, n) = m.now;
  a.topRightCorner(n, n) = m.late;
  const auto node = [nodes](int i) { return std::cos(std::numbers::pi * i / nodes); };
  const auto weight = [nodes](int i) { return (i == 0 || i == nodes ? 2.0 : 1.0) * (i % 2 == 0 ? 1.0 : -1.0); };
  for (int i = 1; i <= nodes; ++i) {
    double diagonal = 0.0;
    for (int j = 0; j <= nodes; ++j) {
      if (i == j) continue;
      const double d = 2.0 / tau * weight(i) / weight(j) / (node(i) - node(j));
      diagonal -= d;
      a.block(i * n, j * n, n, n).diagonal().setConstant(d);
    }
    a.block(i * n, i * n, n, n).diagonal().setConstant(diagonal);
  }
  return eigenvalues(a);
}

// Golden by another method. The same roots come out of the discretised generator of the state space.
TEST(CharacteristicRoots, AgreeWithALargeDiscretisationOfTheStateSpace) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const Rig rig = random_rig(seed, false);
    const LinearRig linear = linearise(rig);
    if (linear.delay() < 1e-3) continue;
    const RootSet set = characteristic_roots(linear.equation(linear.delay()), -40.0);
    const std::vector<Complex> other = eigenvalues_of_generator(matrices_of(rig), linear.delay(), 24);
    int right = 0;
    for (const Complex s : other) {
      right += s.real() > set.line ? 1 : 0;
    }
    EXPECT_EQ(right, set.count);
    for (const Complex s : set.roots) {
      double nearest = 1e300;
      for (const Complex z : other) nearest = std::min(nearest, std::abs(s - z));
      EXPECT_LT(nearest, 1e-6 * std::abs(s)) << s;  // QR on a matrix of size 1e5: 1e-16 · 1e5 and its conditioning
    }
  }
}

// Law. Random rigs with every linear effect: the count is proven, residuals are at rounding, and the number of unstable
// roots counted from the crossings on the way from no delay is the same.
TEST(CharacteristicRoots, AreProvenForRandomRigsAtAnyDelay) {
  for (unsigned seed = 100; seed < 250; ++seed) {
    SCOPED_TRACE(seed);
    const Rig rig = random_rig(seed, true);
    const LinearRig linear = linearise(rig);
    std::mt19937_64 random(seed);
    const double delay = std::uniform_real_distribution<double>(0.0, 0.05)(random);
    const RootSet set = characteristic_roots(linear.equation(delay), -60.0);
    EXPECT_LT(set.worst_residual, 1000.0);
    int unstable = 0;
    for (const Complex s : set.roots) {
      EXPECT_GT(s.real(), set.line);
      EXPECT_GE(s.imag(), 0.0);
      unstable += s.real() > 0.0 ? (s.imag() > 0.0 ? 2 : 1) : 0;
    }
    EXPECT_TRUE(
        std::is_sorted(set.roots.begin(), set.roots.end(), [](Complex a, Complex b) { return a.real() > b.real(); }));
    const auto counted = unstable_roots(linear.p, linear.q, crossing_frequencies(linear.p, linear.q), delay);
    ASSERT_TRUE(counted);
    EXPECT_EQ(unstable, *counted);
    EXPECT_EQ(linear.equation(delay).roots_right_of(1e-7), unstable);
  }
}

// Law. What grows in a time simulation with small steps is what has a root on the right, and at its rate.
TEST(CharacteristicRoots, AgreeWithTimeSimulation) {
  for (unsigned seed = 300; seed < 330; ++seed) {
    SCOPED_TRACE(seed);
    const Rig rig = linear_part(random_rig(seed, seed % 2 == 0));
    const double period = 1e-4;
    const LinearRig linear = linearise(rig);
    if (rig.effects.get<model::TopMount>().active) continue;  // see HasTheCharacteristicEquationWrittenByHand
    // The held force is late by half a step.
    const RootSet set = characteristic_roots(linear.equation(linear.delay() + 0.5 * period), -60.0);
    const model::RigModel<> model(rig, period);
    auto x = model.start();
    model::RigModel<>::Input in;
    in.foot_point.position = 0.01;  // a step of the road
    // Long enough for the rightmost pair to be alone: the second pair is e⁻⁶ of it, or it is no fair question.
    const double gap = set.roots.size() > 1 ? set.roots[0].real() - set.roots[1].real() : 10.0;
    if (gap < 0.5) continue;
    const double alone = std::min(6.0 / gap, 8.0), watched = 1.0;
    const auto run = [&](double duration, double& highest) {
      highest = 0.0;
      for (int k = 0; k < static_cast<int>(duration / period); ++k) {
        model.step(x, in);
        const auto d = model.deflection(x);
        highest = std::max(highest, std::hypot(d.position * std::abs(set.roots[0]), d.velocity));
      }
    };
    double ignored = 0.0, first = 0.0, second = 0.0;
    run(alone, ignored);
    run(watched, first);
    run(watched, second);
    if (!(first > 1e-200) || !(second > 1e-200)) continue;
    const double rate = std::log(second / first) / watched;
    // Maxima of a decaying oscillation are read to within a period: ± |Re|/f, and what is left of the second pair.
    const double expected = set.roots[0].real();
    EXPECT_NEAR(rate, expected, 0.1 + 0.1 * std::abs(expected));
  }
}

}  // namespace
