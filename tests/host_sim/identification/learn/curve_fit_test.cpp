// A free curve over what the recordings excite.
#include "host_sim/identification/learn/curve_fit.hpp"

#include <gtest/gtest.h>

#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

// Fault. A rig that is only ever pulled: the curve has points on one side and 0, and is fitted like any other.
TEST(CurveFit, StandsOnOneSideOfZero) {
  firmware::RigDescription truth = sample::bench();
  truth.rig.suspension.stiffness *= 1.1;
  firmware::Recording pulled = sample::recorded(truth, 8.0);
  constexpr double by = 0.2;  // [m], more than the stroke
  for (const Channel channel : {Channel::x_cmd, Channel::x_act}) {
    for (double& x : pulled[channel]) x += by;
  }
  const firmware::RigDescription described = sample::bench();
  std::vector<PreparedRecording> recordings{prepare_recording(described, pulled, Use::shared, false)};
  const Hypothesis given = described_hypothesis(described, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  const SearchSpace space = search_space(described, problem.samples(), given);

  const auto range = excited_range(problem, given, CurvePlace::suspension, CurveOver::deflection);
  ASSERT_TRUE(range);
  EXPECT_EQ(range->lowest, 0.0);
  EXPECT_NEAR(range->highest, by, by);
  Hypothesis start = given;
  start.laws.push_back(flat_curve(CurvePlace::suspension, CurveOver::deflection, *range));
  EXPECT_EQ(start.laws.back().at.front(), 0.0);
  start.laws.back().size = 100.0;
  put_laws(start.laws, start.rig);
  const auto curve = fit_curve(problem, space, start, {}, 2);
  ASSERT_TRUE(curve);
  EXPECT_GT(curve->gain, 0.0);
}

}  // namespace
