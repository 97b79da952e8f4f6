// The one non-linear solver, on problems whose minimum is known.
#include "host_sim/least_squares/gauss_newton.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using host_sim::full_gauss_newton_steps;
using host_sim::gauss_newton;
using host_sim::NormalEquations;
using host_sim::StepBox;

/// Rosenbrock's valley as least squares: r = (10 (v − u²), 1 − u), minimum 0 at (1, 1). Counts what a solver asks for.
struct Rosenbrock {
  Eigen::Vector2d u{-1.2, 1.0}, lower{-5.0, -5.0}, upper{5.0, 5.0}, tried{};
  Eigen::Matrix2d jacobian{};
  int jacobians = 0, steps = 0;

  static Eigen::Vector2d residual(const Eigen::Vector2d& x) { return {10.0 * (x(1) - x(0) * x(0)), 1.0 - x(0)}; }
  bool find_jacobian() {
    ++jacobians;
    jacobian << -20.0 * u(0), 10.0, -1.0, 0.0;
    return true;
  }
  [[nodiscard]] NormalEquations normal_equations() const {
    return {jacobian.transpose() * jacobian, jacobian.transpose() * residual(u)};
  }
  [[nodiscard]] StepBox box(double trust) const { return {trust * (lower - u), trust * (upper - u)}; }
  [[nodiscard]] double chi_squared() const { return residual(u).squaredNorm(); }
  std::optional<double> try_step(const Eigen::VectorXd& d) {
    ++steps;
    tried = u + d;
    if (tried(0) < -1.9) return std::nullopt;  // "no such rig"
    return residual(tried).squaredNorm();
  }
  void accept() { u = tried; }
  double move(const Eigen::VectorXd& d) {
    u += d;
    return d.norm();
  }
};

// Law. The minimum is found though whole steps leave the valley and some points are no model.
TEST(GaussNewton, FindsTheMinimumOfACurvedValley) {
  Rosenbrock problem;
  gauss_newton(problem, {.most_steps = 200, .enough = 1e-18, .enough_relative = 1e-12});
  EXPECT_NEAR(problem.u(0), 1.0, 1e-5);
  EXPECT_NEAR(problem.u(1), 1.0, 1e-5);
}

// Law. With a bound u ≤ 0.5 the minimum is (0.5, 0.25): only 1 − u is left.
TEST(GaussNewton, StopsAtABound) {
  Rosenbrock problem;
  problem.upper(0) = 0.5;
  gauss_newton(problem, {.most_steps = 200, .enough = 1e-18, .enough_relative = 1e-12});
  EXPECT_NEAR(problem.u(0), 0.5, 1e-9);
  EXPECT_NEAR(problem.u(1), 0.25, 1e-5);
  EXPECT_NEAR(problem.chi_squared(), 0.25, 1e-8);
}

/// r = (1 − u, 0.01 − 0.001 v + 5000 v²): the slope along v says nothing of what a step along it does.
struct Deceptive {
  Eigen::Vector2d u = Eigen::Vector2d::Zero(), tried{};
  Eigen::Matrix2d jacobian{};

  static Eigen::Vector2d residual(const Eigen::Vector2d& x) {
    return {1.0 - x(0), 0.01 - 0.001 * x(1) + 5000.0 * x(1) * x(1)};
  }
  bool find_jacobian() {
    jacobian << -1.0, 0.0, 0.0, -0.001 + 10000.0 * u(1);
    return true;
  }
  [[nodiscard]] NormalEquations normal_equations() const {
    return {jacobian.transpose() * jacobian, jacobian.transpose() * residual(u)};
  }
  [[nodiscard]] StepBox box(double trust) const {
    return {Eigen::Vector2d::Constant(-trust), Eigen::Vector2d::Constant(trust)};
  }
  [[nodiscard]] double chi_squared() const { return residual(u).squaredNorm(); }
  std::optional<double> try_step(const Eigen::VectorXd& d) {
    tried = u + d;
    return residual(tried).squaredNorm();
  }
  void accept() { u = tried; }
};

// Law. One direction whose steps are all too long does not end the fit: in a smaller box the others go on. Even 1.5 %
// of the first step, 0.015 along v, is worth 1.2, more than the 0.03 that it gains along u.
TEST(GaussNewton, GoesOnInASmallerBox) {
  Deceptive problem;
  gauss_newton(problem, {.most_steps = 60, .enough = 1e-9, .enough_relative = 1e-9});
  EXPECT_NEAR(problem.u(0), 1.0, 1e-3);
  EXPECT_LT(problem.chi_squared(), 2e-4) << "0.01 squared and a little";
}

/// A line: r = A u − b. Its Jacobian is the same everywhere.
struct Line {
  Eigen::Vector2d u = Eigen::Vector2d::Zero(), tried{};
  Eigen::Matrix2d a{{2.0, 1.0}, {0.5, 3.0}};
  Eigen::Vector2d b{1.0, -2.0};
  int jacobians = 0;
  double diverges_beyond = std::numeric_limits<double>::infinity();

  bool find_jacobian() {
    ++jacobians;
    return true;
  }
  [[nodiscard]] NormalEquations normal_equations() const { return {a.transpose() * a, a.transpose() * (a * u - b)}; }
  [[nodiscard]] StepBox box(double) const { return {Eigen::Vector2d::Constant(-9.0), Eigen::Vector2d::Constant(9.0)}; }
  [[nodiscard]] double chi_squared() const { return (a * u - b).squaredNorm(); }
  std::optional<double> try_step(const Eigen::VectorXd& d) {
    tried = u + d;
    return tried.norm() > diverges_beyond ? std::numeric_limits<double>::quiet_NaN() : (a * tried - b).squaredNorm();
  }
  void accept() { u = tried; }
  double move(const Eigen::VectorXd& d) {
    u += d;
    return d.norm();
  }
};

// Law. What is linear is solved in one step, and a Jacobian that predicts well is not found again.
TEST(GaussNewton, KeepsAJacobianThatPredictsWell) {
  Line line;
  gauss_newton(line, {.most_steps = 12, .enough = 1e-12, .enough_relative = 1e-12});
  EXPECT_LT((line.a * line.u - line.b).norm(), 1e-9);
  EXPECT_LE(line.jacobians, 2) << "one for the step, at most one to see that it is the end";
  Line again;
  full_gauss_newton_steps(again, 9, 1e-9);
  EXPECT_LT((again.a * again.u - again.b).norm(), 1e-9);
  EXPECT_EQ(again.jacobians, 2) << "the second step moves nothing";
}

// Law. A point whose χ² is not a number is never accepted.
TEST(GaussNewton, NeverAcceptsADivergedPoint) {
  Line line;
  line.diverges_beyond = 0.5;  // the minimum lies at 1.23
  const double before = line.chi_squared();
  gauss_newton(line, {.most_steps = 12});
  EXPECT_TRUE(std::isfinite(line.chi_squared()));
  EXPECT_LT(line.chi_squared(), before);
  EXPECT_LE(line.u.norm(), 0.5);
}

}  // namespace
