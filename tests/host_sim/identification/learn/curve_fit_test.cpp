// A free curve over what the recordings excite.
#include "host_sim/identification/learn/curve_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
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
  // All that is recorded, also what is held out and the rarest samples.
  const std::vector<double>& x = problem.samples().front().recording[Channel::x_act];
  EXPECT_NEAR(range->farthest, *std::max_element(x.begin(), x.end()), 1e-3);
  EXPECT_GT(range->farthest, range->highest);
  Hypothesis start = given;
  start.laws.push_back(flat_curve(CurvePlace::suspension, CurveOver::deflection, *range));
  EXPECT_EQ(start.laws.back().at.front(), 0.0);
  start.laws.back().size = 100.0;
  put_laws(start.laws, start.rig);
  const auto curve = fit_curve(problem, space, start, {}, 2);
  ASSERT_TRUE(curve);
  EXPECT_GT(curve->gain, 0.0);
}

// Truth by construction. A described curve of which the rig has twice the force: the points beside it, of which the
// page draws a figure, lie at twice the curve within the noise of F.
TEST(CurveFit, ADescribedCurveStandsBesideWhatTheRigDid) {
  const std::string head =
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 30000.0\ndamping = 1000.0\n"
      "[noise]\nF = 10.0\nx_act = 2e-5\n[laws.bush]\nplace = 'suspension'\nover = 'deflection'\n"
      "at = [-0.01, 0.0, 0.01]\n";
  const firmware::RigDescription described = firmware::parse_rig(head + "value = [-900.0, 0.0, 900.0]\n", "rig.toml");
  const firmware::RigDescription truth = firmware::parse_rig(head + "value = [-1800.0, 0.0, 1800.0]\n", "rig.toml");
  const Diagnosis found = diagnose(described, {{sample::recorded(truth, 8.0), Use::shared}});
  ASSERT_EQ(found.described_curves.size(), 1U);
  const DescribedLaw& bush = found.described_curves.front();
  EXPECT_EQ(bush.words, "bush");
  ASSERT_GT(bush.seen_at.size(), 100U);
  for (std::size_t k = 0; k < bush.seen_at.size(); ++k) {
    EXPECT_NEAR(bush.seen_force[k], 2.0 * 90e3 * bush.seen_at[k], 6.0 * sample::force_noise + 30.0) << k;
  }
  EXPECT_NE(report_html(found, described).find("[laws.bush] at the suspension"), std::string::npos);
}

}  // namespace
