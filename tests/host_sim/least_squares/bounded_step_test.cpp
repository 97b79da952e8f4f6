// The linear least-squares problem with bounds.
#include "host_sim/least_squares/bounded_step.hpp"

#include <gtest/gtest.h>

#include "tests/support/reference_road.hpp"

namespace {

using host_sim::bounded_step;

// Law. The step is the minimum inside the box: no point of a fine grid over it is lower.
TEST(BoundedStep, IsTheMinimumInsideTheBounds) {
  support::NormalNoise noise(3);
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::Matrix2d a;
    a << noise(), noise(), noise(), noise();
    const Eigen::Matrix2d h = a.transpose() * a + 0.01 * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d g(noise(), noise()), lower(-0.5, -0.3), upper(0.4, 0.6);
    const Eigen::VectorXd d = bounded_step(h, g, {lower, upper});
    const auto cost = [&](const Eigen::Vector2d& v) { return 0.5 * v.dot(h * v) + g.dot(v); };
    ASSERT_TRUE((d.array() >= lower.array() - 1e-12).all() && (d.array() <= upper.array() + 1e-12).all());
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 40; ++j) {
        const Eigen::Vector2d v(lower(0) + (upper(0) - lower(0)) * i / 40.0,
                                lower(1) + (upper(1) - lower(1)) * j / 40.0);
        EXPECT_GE(cost(v), cost(d) - 1e-9) << "seed 3, trial " << trial;
      }
    }
  }
}

// Point. Without active bounds it is the solution of the normal equations; a direction that nothing determines stays 0;
// no unknowns, no step.
TEST(BoundedStep, SolvesTheNormalEquationsInsideAWideBox) {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  h.topLeftCorner(2, 2) << 4.0, 1.0, 1.0, 3.0;
  const Eigen::Vector3d g(1.0, -2.0, 0.0), wide = Eigen::Vector3d::Constant(1e6);
  const Eigen::VectorXd d = bounded_step(h, g, {-wide, wide});
  EXPECT_NEAR(d(0), -5.0 / 11.0, 1e-10);  // (−g₀·3 + g₁·1)/11, (g₀ + 8)/11
  EXPECT_NEAR(d(1), 9.0 / 11.0, 1e-10);
  EXPECT_EQ(d(2), 0.0);
  EXPECT_EQ(bounded_step(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0), {{}, {}}).size(), 0);
}

}  // namespace
