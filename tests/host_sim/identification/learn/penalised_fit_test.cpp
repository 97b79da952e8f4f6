// What the data know of a law while everything else makes way.
#include "host_sim/identification/learn/penalised_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host_sim/identification/learn/curve_fit.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;

// Law. A curve over the deflection that is straight is a stiffness, and the bench's own is tolerated by 5 % of 30 kN/m
// either way: as a standard deviation 3 kN/m/√12 = 866 N/m. So much of a straight curve is worth 1 in χ², however long
// the recording is; one that bends is known far better.
TEST(PenalisedFit, LetsEverythingElseMakeWay) {
  const firmware::RigDescription bench = sample::bench();
  std::vector<PreparedRecording> prepared = sample::prepared(bench, bench);
  const Hypothesis given = described_hypothesis(bench, prepared);
  const IdentificationProblem problem(std::move(prepared), given);
  const SearchSpace space = search_space(bench, problem.samples(), given);
  const auto range = excited_range(problem, given, CurvePlace::suspension, CurveOver::deflection);
  ASSERT_TRUE(range);
  Hypothesis start = given;
  start.laws.push_back(flat_curve(CurvePlace::suspension, CurveOver::deflection, *range));
  // A slope of its own, which the rig's gives up: of a flat table monotone cubics are not linear in the values.
  constexpr double slope = 1000.0;
  PlacedLaw& law = start.laws.back();
  for (std::size_t i = 0; i < law.at.size(); ++i) law.values[i] = slope * law.at[i];
  law.size = 50.0;
  start.rig.suspension.stiffness -= slope;
  put_laws(start.laws, start.rig);

  std::vector<double> at = law.at;
  std::erase(at, 0.0);
  const auto count = static_cast<Eigen::Index>(at.size());
  PenalisedFit fit(problem, space, start, {}, Eigen::MatrixXd::Identity(count, count), 0);
  ASSERT_TRUE(fit.is_finite());
  fit.run(0);
  const LawInformation& known = fit.known();
  EXPECT_EQ(known.scale, 50.0);
  Eigen::VectorXd straight(count), bent(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double x = at[static_cast<std::size_t>(i)];
    straight(i) = 3000.0 / std::sqrt(12.0) * x / known.scale;
    bent(i) = std::abs(straight(i));
    EXPECT_NEAR(known.now(i), slope * x / known.scale, 1e-12);
  }
  EXPECT_NEAR(straight.dot(known.matrix * straight) / known.temper, 1.0, 0.05);
  EXPECT_GT(bent.dot(known.matrix * bent) / known.temper, 10.0);
  EXPECT_GT(known.freedom(), 0.0);
  EXPECT_LT(known.freedom(), static_cast<double>(count));
}

// Law. Bends by hand: of a straight line none, of x² at 0, 1, 3 half of the product of the distances times F″.
TEST(PenalisedFit, BendsAreDistancesFromTheStraightLine) {
  const Eigen::MatrixXd b = bends({-1.0, 0.0, 1.0, 3.0});
  EXPECT_NEAR((b * Eigen::Vector4d(-1.0, 0.0, 1.0, 3.0)).norm(), 0.0, 1e-15);
  const Eigen::VectorXd of_square = b * Eigen::Vector4d(1.0, 0.0, 1.0, 9.0);
  EXPECT_NEAR(of_square(0), -1.0 * 1.0, 1e-15);
  EXPECT_NEAR(of_square(1), -1.0 * 2.0, 1e-15);
}

}  // namespace
