// Stacks of branches with memory, learned.
#include "host_sim/identification/learn/stack_fit.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"
#include "tests/host_sim/identification/select/bench_problem.hpp"

namespace {

using namespace host_sim::identification;
using sample::Bench;

/// Two sliders far apart: 60 N that slide after 0.2 mm, 150 N after 4 mm.
firmware::RigDescription with_sliders() {
  firmware::RigDescription rig = sample::bench();
  rig.rig.laws.branches[rig.rig.laws.branch_count++] = {.stiffness = 60.0 / 0.2e-3, .slip_force = 60.0};
  rig.rig.laws.branches[rig.rig.laws.branch_count++] = {.stiffness = 150.0 / 4e-3, .slip_force = 150.0};
  return rig;
}

// Law. The grid halves from half of the stroke on, as many sliders as there is room for; times grow threefold.
TEST(StackFit, GridsCoverStrokeAndTime) {
  const ExcitedRange range{-12e-3, 20e-3, 6e-3};
  const PlacedLaw sliders = empty_stack(LawFamily::sliders, range, 2);
  ASSERT_EQ(sliders.at.size(), 6U);
  EXPECT_NEAR(sliders.at[0], 8e-3, 1e-15);
  EXPECT_NEAR(sliders.at[5], 0.25e-3, 1e-15);
  const PlacedLaw maxwell = empty_stack(LawFamily::maxwell, range, 0);
  ASSERT_EQ(maxwell.at.size(), 8U);
  EXPECT_NEAR(maxwell.at[1] / maxwell.at[0], 3.0, 1e-12);
}

// Truth by construction. Neither slip travel is on the grid: each is drawn by its two neighbours at most, and the
// forces are those of the hidden stack. Bounds: between two points of a grid of factor 2, clamp(x/d) is drawn by its
// neighbours within 0.09 of its force.
TEST(StackFit, FindsTheForcesOfAHiddenStack) {
  Bench bench(with_sliders(), 16.0);
  Hypothesis start = bench.given;
  const auto range = excited_range(bench.problem, start, CurvePlace::suspension, CurveOver::deflection);
  ASSERT_TRUE(range);
  start.laws.push_back(empty_stack(LawFamily::sliders, *range, 0));
  start.laws.back().size = 20.0;
  put_laws(start.laws, start.rig);
  const auto model = fit_stack(bench.problem, bench.space, start, {}, SelectionCriterion{});
  ASSERT_TRUE(model);
  const std::size_t kept = branch_count(model->fit.hypothesis);
  EXPECT_GE(kept, 2U);
  EXPECT_LE(kept, 5U);
  const PlacedLaw& law = model->fit.hypothesis.laws.back();
  EXPECT_NEAR(law.force(range->largest()), 210.0, 0.09 * 210.0);
  EXPECT_NEAR(law.force(0.4e-3), 60.0 + 15.0, 0.09 * 210.0);
  const double before = residuals(bench.problem, predict(bench.problem, bench.given)).squaredNorm();
  EXPECT_LT(model->fit.chi_squared, 0.05 * before);
}

// Journey. A diagnosis says hysteresis, with its force, and puts the branches into the rig.
TEST(StackFit, DiagnosisSaysHysteresis) {
  const Diagnosis found = diagnose(sample::bench(), {{sample::recorded(with_sliders(), 16.0), Use::shared}});
  ASSERT_EQ(found.laws.size(), 1U);
  const DescribedLaw& law = found.laws.front();
  EXPECT_EQ(law.shape, "hysteresis");
  EXPECT_NEAR(law.numbers.at(0).value, 210.0, 0.09 * 210.0);
  EXPECT_NE(law.words.find("independent of frequency"), std::string::npos) << law.words;
  EXPECT_GE(found.rig.rig.laws.branch_count, 2);
  const auto json = to_json(found);
  EXPECT_EQ(json["laws"][0]["memory"], true);
  EXPECT_EQ(json["laws"][0]["branches"].size(), found.rig.rig.laws.branch_count);
}

// Journey. Lost motion of 3 mm in series with both sliders is found and said, with an interval, and stands in the rig.
TEST(StackFit, DiagnosisSaysLostMotion) {
  constexpr double gap = 3e-3;
  firmware::RigDescription hidden = with_sliders();
  for (auto& branch : hidden.rig.laws.branches) branch.gap = branch.slip_force > 0.0 ? gap : 0.0;
  const Diagnosis found = diagnose(sample::bench(), {{sample::recorded(hidden, 16.0), Use::shared}});
  ASSERT_EQ(found.laws.size(), 1U);
  const DescribedLaw& law = found.laws.front();
  EXPECT_EQ(law.shape, "hysteresis");
  EXPECT_NE(law.words.find("lost motion"), std::string::npos) << law.words;
  ASSERT_EQ(law.numbers.back().name, "lost_motion");
  EXPECT_NEAR(law.numbers.back().value, gap, 0.1 * gap);
  EXPECT_LT(law.numbers.back().lower, law.numbers.back().value);
  EXPECT_NEAR(found.rig.rig.laws.branches[0].gap, gap, 0.1 * gap);
  EXPECT_EQ(to_json(found)["laws"][0]["branches"][0]["gap"], law.law.gap);
}

// Journey. A damper ∝ |v|^2.5 beside the sliders: both are learned, the second beside the first.
TEST(StackFit, DiagnosisLearnsACurveBesideBranches) {
  firmware::RigDescription hidden = with_sliders();
  PlacedLaw power;
  power.family = LawFamily::power;
  power.rms = 0.06;
  power.largest = 0.3;
  power.values = {60.0, 2.5};
  put_laws({power}, hidden.rig);
  const Diagnosis found = diagnose(sample::bench(), {{sample::recorded(hidden, 16.0), Use::shared}});
  ASSERT_EQ(found.laws.size(), 2U) << found.effects.size();
  const bool first = has_memory(found.laws[0].law.family);
  EXPECT_NE(first, has_memory(found.laws[1].law.family));
  const DescribedLaw& curve = found.laws[first ? 1 : 0];
  EXPECT_EQ(curve.law.over, CurveOver::velocity);
  EXPECT_NEAR(curve.law.force(0.15), power.force(0.15), 0.1 * power.force(0.15)) << curve.words;
}

}  // namespace
