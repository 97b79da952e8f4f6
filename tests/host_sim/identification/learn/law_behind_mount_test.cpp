// A law behind a spring in series, read off force and stroke.
#include "host_sim/identification/learn/law_behind_mount.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/predict/placed_law.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

/// A damper with a knee behind a mount, made from its inside: x_i(t) is prescribed, F = F₀ + f(ẋ_i), x_act = x_i + F/k.
/// So the record is exact whatever k is. An infinite k: without a mount.
IdentificationProblem problem_with(double k, double offset) {
  const firmware::RigDescription rig = firmware::parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 0.0\ndamping = 5000.0\n"
      "[noise]\nF = 2.0\nx_act = 2e-5\n",
      "rig.toml");
  firmware::Recording r = sample::recorded(rig, 8.0);
  const double w1 = 2.0 * std::numbers::pi * 1.3, w2 = 2.0 * std::numbers::pi * 3.1;
  for (std::size_t n = 0; n < r.size(); ++n) {
    const double t = r.time[n];
    const double x = 0.010 * std::sin(w1 * t) + 0.002 * std::sin(w2 * t);
    const double v = 0.010 * w1 * std::cos(w1 * t) + 0.002 * w2 * std::cos(w2 * t);
    const double size = std::abs(v), knee = 0.04;
    const double f = std::copysign(size < knee ? 18e3 * size : 18e3 * knee + 1e3 * (size - knee), v);
    r[Channel::F][n] = offset + f;
    r[Channel::x_act][n] = x + (offset + f) / k;
  }
  if (r.has(Channel::x_cmd)) r[Channel::x_cmd].clear();
  std::vector<PreparedRecording> prepared{prepare_recording(rig, r, Use::shared, false)};
  const Hypothesis given = described_hypothesis(rig, prepared);
  return IdentificationProblem(std::move(prepared), given);
}

// Truth by construction. Mount, offset and both slopes. Differences over 2 ms of 3.1 Hz are right to (ω h)²/6 = 6e-5,
// and a line between points 0.05 … 1 rms apart cuts the knee: 2 % of k, 3 % of the slopes. The offset is taken off with
// the mean of F where F is tared.
TEST(LawBehindMount, FindsTheMountAndTheLaw) {
  const auto found = law_behind_mount(problem_with(430e3, -70.0));
  ASSERT_TRUE(found);
  const auto f = [&](double velocity) { return between(found->at, found->force, velocity); };
  EXPECT_NEAR(found->stiffness, 430e3, 0.02 * 430e3);
  EXPECT_NEAR(f(0.02) / 0.02, 18e3, 0.03 * 18e3);
  EXPECT_NEAR(f(-0.02) / -0.02, 18e3, 0.03 * 18e3);
  EXPECT_NEAR((f(0.09) - f(0.06)) / 0.03, 1e3, 300.0) << "the slope behind the knee, on what 1.1 kN leaves";
  EXPECT_EQ(f(0.0), 0.0);
}

// Law. Ten times the stiffness is found as ten times the stiffness, or, where it moves x_act by less than the noise,
// as none.
TEST(LawBehindMount, FollowsTheMountAndFindsNoneWhereThereIsNone) {
  const auto stiff = law_behind_mount(problem_with(1.2e6, 0.0));
  ASSERT_TRUE(stiff);
  EXPECT_NEAR(stiff->stiffness, 1.2e6, 0.05 * 1.2e6);
  const auto rigid = law_behind_mount(problem_with(INFINITY, 0.0));
  EXPECT_TRUE(!rigid || rigid->stiffness > 2e7) << "half a thousandth of the stroke";
}

}  // namespace
