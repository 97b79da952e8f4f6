// Causes that the recordings do not bear out.
#include "host_sim/identification/assess/cause_support.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/identification/select/model_evidence.hpp"
#include "host_sim/identification/select/model_fitter.hpp"
#include "tests/host_sim/identification/select/bench_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;
using sample::Bench;

/// A model with one effect as it is, not fitted, beside the model without effects.
SearchResult found_with(Bench& bench, const firmware::PlacedEffect& effect, int most) {
  const SelectionCriterion criterion;
  const ModelFitter fitter(bench.problem, bench.space.common, criterion);
  SearchResult found;
  found.nothing = fitter.refitted(bench.given, {});
  Hypothesis with = found.nothing.fit.hypothesis;
  firmware::put_effect(with.rig, effect);
  found.best = fitter.refitted(with, {effect}, most);
  found.causes.resize(1);
  return found;
}

// Point. Friction of 40 N that hides: its share is what the error falls by, nearly all of it.
TEST(CauseSupport, SharesTheErrorThatGoesWithACause) {
  Bench bench(sample::with_effect(sample::bench(), "coulomb_friction", {40.0}), 5.0);
  SearchResult found = found_with(bench, {firmware::find_effect("coulomb_friction"), std::nullopt, {30.0}}, 6);
  const auto error = [&](const CandidateModel& model) {
    return error_of_prediction(bench.problem, model.fit.hypothesis);
  };
  const auto shares = support_of_causes(bench.problem, bench.problem, bench.space, false, found).shares;
  ASSERT_EQ(shares.size(), 1U);
  EXPECT_NEAR(shares[0], 1.0 - error(found.best) / error(found.nothing), 1e-9);
  EXPECT_GT(shares[0], 0.05);
}

// Law. What makes the prediction of held-out data worse leaves the model; what makes it better stays.
TEST(CauseSupport, LeavesOutWhatRaisesTheError) {
  Bench bench(sample::with_effect(sample::bench(), "coulomb_friction", {40.0}), 5.0);
  SearchResult worse = found_with(bench, {firmware::find_effect("sensor_gain"), Channel::F, {3.0}}, 0);
  const auto left_out = support_of_causes(bench.problem, bench.problem, bench.space, true, worse).left_out;
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_EQ(left_out[0], "sensor_gain of F");
  EXPECT_TRUE(worse.best.effects.empty());
  EXPECT_TRUE(worse.causes.empty());
  SearchResult better = found_with(bench, {firmware::find_effect("coulomb_friction"), std::nullopt, {30.0}}, 6);
  const CauseSupport support = support_of_causes(bench.problem, bench.problem, bench.space, true, better);
  EXPECT_TRUE(support.left_out.empty());
  ASSERT_EQ(support.shares.size(), 1U);
  EXPECT_GT(support.shares[0], 0.05);
  EXPECT_EQ(better.best.effects.size(), 1U);
}

// Law. A parameter whose interval reaches both bounds says nothing: its cause is listed as undetermined, and everything
// else is fitted without it. An interval that reaches one bound, or none, is an answer.
TEST(CauseSupport, NamesNothingWhoseSizeIsOpen) {
  Bench bench(sample::bench(), 5.0);
  const SearchResult gain = found_with(bench, {firmware::find_effect("sensor_gain"), Channel::F, {1.01}}, 0);
  Uncertainty known;
  known.half_widths = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(gain.best.fit.parameters.size()));
  const FreeParameter& parameter = gain.best.fit.parameters.back();
  const double u = parameter.get(gain.best.fit.hypothesis);
  const double nearer = std::min(u - parameter.lower, parameter.upper - u);
  const double farther = std::max(u - parameter.lower, parameter.upper - u);
  ASSERT_LT(nearer, farther);
  SearchResult known_well = gain;
  known.half_widths.tail<1>()(0) = 0.5 * (nearer + farther);
  EXPECT_TRUE(leave_out_undetermined(bench.problem, bench.space, known, known_well).empty());
  EXPECT_EQ(known_well.best.effects.size(), 1U);
  SearchResult open = gain;
  known.half_widths.tail<1>()(0) = 1.01 * farther;
  const auto list = leave_out_undetermined(bench.problem, bench.space, known, open);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].cause, "sensor_gain of F");
  EXPECT_TRUE(open.best.effects.empty());
  EXPECT_TRUE(open.causes.empty());
}

// Law. With the evidence of model_evidence.hpp friction that is there is worth more than it costs, and a gain beside it
// that is not is worth less.
TEST(ModelEvidence, RanksWhatIsThereAboveWhatIsNot) {
  Bench bench(sample::with_effect(sample::bench(), "coulomb_friction", {40.0}), 5.0);
  const SearchResult friction = found_with(bench, {firmware::find_effect("coulomb_friction"), std::nullopt, {30.0}}, 6);
  const Scales scales = scales_of(bench.problem.samples(), friction.nothing.fit.hypothesis,
                                  read_all(bench.problem, friction.nothing.fit.hypothesis));
  const SelectionCriterion criterion;
  const ModelFitter fitter(bench.problem, bench.space.common, criterion);
  Hypothesis start = friction.best.fit.hypothesis;
  auto effects = friction.best.effects;
  effects.push_back({firmware::find_effect("sensor_gain"), Channel::F, {1.001}});
  firmware::put_effect(start.rig, effects.back());
  const CandidateModel longer = fitter.refitted(start, effects, 6);
  for (const bool by_power : {false, true}) {
    Tempering tempering;
    tempering.by_power = by_power;
    const auto total = [&](const CandidateModel& model) {
      return evidence_of(bench.problem, model, scales, tempering).total();
    };
    EXPECT_LT(total(friction.best), total(friction.nothing) - 10.0) << by_power;
    EXPECT_GT(total(longer), total(friction.best)) << by_power;
  }
}

}  // namespace
