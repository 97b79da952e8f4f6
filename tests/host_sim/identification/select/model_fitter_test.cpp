// Candidates, what they must gain, and fits of them beside a model.
#include "host_sim/identification/select/model_fitter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/select/candidates.hpp"
#include "host_sim/identification/select/linear_refit.hpp"
#include "host_sim/identification/select/search.hpp"
#include "host_sim/identification/select/search_under_model_error.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/selection_criterion.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"
#include "tests/host_sim/identification/select/bench_problem.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;
using sample::Bench;

CandidateModel model_with(double chi_squared, std::size_t effects, std::size_t residuals = 1000) {
  CandidateModel model;
  model.fit.chi_squared = chi_squared;
  model.fit.residual = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(residuals));
  for (std::size_t i = 0; i < effects; ++i) {
    model.effects.push_back({firmware::find_effect("viscous_damping"), std::nullopt, {1.0}});
  }
  return model;
}

// Point. An effect of one parameter costs 40 of χ² and must explain 3 % of what is left, a second one 30 %.
TEST(SelectionCriterion, WantsFortyAndAShareOfWhatIsLeft) {
  const SelectionCriterion criterion;
  EXPECT_EQ(model_with(1500.0, 1).penalised_chi_squared(criterion), 1540.0);
  const CandidateModel nothing = model_with(2000.0, 0);
  EXPECT_EQ(beyond_noise(nothing.fit), 1000.0);
  EXPECT_TRUE(criterion.accepts(model_with(1959.0, 1), nothing, 0.0));
  EXPECT_FALSE(criterion.accepts(model_with(1961.0, 1), nothing, 0.0));
  EXPECT_FALSE(criterion.accepts(model_with(1959.0, 1), nothing, 0.05)) << "5 % of 1000 are 50";
  EXPECT_EQ(criterion.share(nothing), 0.03);
  EXPECT_EQ(criterion.share(model_with(1500.0, 1)), 0.30);
  const CandidateModel diverged = model_with(std::numeric_limits<double>::infinity(), 1);
  EXPECT_TRUE(criterion.prefers(nothing, diverged));
  EXPECT_FALSE(criterion.prefers(diverged, nothing));
}

// Point. From 21 times the noise to 6: 15 of 20 are explained; all of it down to noise; of no excess the least that
// counts.
TEST(ExplainedShare, IsOfThePowerBeyondNoise) {
  EXPECT_DOUBLE_EQ(explained_share(21.0, 6.0, 1000.0), 0.75);
  EXPECT_DOUBLE_EQ(explained_share(21.0, 0.98, 1000.0), 1.0);
  EXPECT_DOUBLE_EQ(explained_share(1.0, 1.0, 1000.0), 1.0);
}

// Law. Candidates are the effects that a bench has a place for, each with starts inside its bounds; an effect that is
// in the hypothesis already is none; nothing on a bench is a tyre.
TEST(Candidates, AreEffectsWithAPlaceThatAreNotThereYet) {
  const Bench bench(sample::bench());
  const Scales scales = scales_of(bench.problem.samples(), bench.given, read_all(bench.problem, bench.given));
  EXPECT_NEAR(scales.motion.deflection, std::sqrt((64.0 + 16.0 + 1.0) / 2.0) * 1e-3, 3e-4)
      << "three sines of 8, 4 and 1 mm";
  const auto list = candidates(bench.problem.samples(), bench.given, scales);
  const auto has = [](const std::vector<Candidate>& all, std::string_view name) {
    return std::any_of(all.begin(), all.end(), [&](const Candidate& c) { return c.entry->name == name; });
  };
  EXPECT_TRUE(has(list, "coulomb_friction"));
  EXPECT_TRUE(has(list, "sensor_lag"));
  EXPECT_FALSE(has(list, "progressive_tyre"));
  EXPECT_FALSE(has(list, "sensor_hold")) << "no value repeats itself";
  for (const Candidate& candidate : list) {
    EXPECT_FALSE(candidate.starts.empty()) << candidate.entry->name;
    for (const Start& start : candidate.starts) {
      EXPECT_EQ(start.values.size(), candidate.entry->parameters.size()) << candidate.entry->name;
    }
  }
  Hypothesis friction = bench.given;
  firmware::put_effect(friction.rig, {firmware::find_effect("coulomb_friction"), std::nullopt, {10.0}});
  EXPECT_FALSE(has(candidates(bench.problem.samples(), friction, scales), "coulomb_friction"));
}

// Law. An effect that contains another one takes its place, beginning where that stands; beside it that is no
// candidate.
TEST(Candidates, TakeThePlaceOfWhatTheyContain) {
  const Bench bench(sample::bench());
  const Scales scales = scales_of(bench.problem.samples(), bench.given, read_all(bench.problem, bench.given));
  Hypothesis rubbing = bench.given;
  firmware::put_effect(rubbing.rig, {firmware::find_effect("coulomb_friction"), std::nullopt, {35.0}});
  bool seen = false;
  for (const Candidate& candidate : candidates(bench.problem.samples(), rubbing, scales)) {
    const bool is_stribeck = candidate.entry->name == "stribeck_friction";
    EXPECT_EQ(candidate.replaces != nullptr, is_stribeck) << candidate.entry->name;
    if (!is_stribeck) continue;
    seen = true;
    EXPECT_EQ(candidate.replaces->name, "coulomb_friction");
    for (const Start& start : candidate.starts) EXPECT_EQ(start.values.front(), 35.0);
  }
  EXPECT_TRUE(seen);
  Hypothesis falling = bench.given;
  firmware::put_effect(falling.rig, {firmware::find_effect("stribeck_friction"), std::nullopt, {35.0, 0.5, 0.02}});
  for (const Candidate& candidate : candidates(bench.problem.samples(), falling, scales)) {
    EXPECT_NE(candidate.entry->name, "coulomb_friction");
  }
}

// Journey. Each of the laws with a shape of its own is found by its name, with its size; the simpler one that it
// contains is not left beside it. In 8 s, Coulomb friction with a damping that falls leaves no more than noise of
// Stribeck friction; in 16 s it does. Bounds: four standard errors, σ_F/√12000 = 0.1 N beside forces of 40 N.
TEST(SelectModel, NamesLawsWithAShapeOfTheirOwn) {
  const std::vector<std::pair<std::string, std::vector<double>>> hidden{{"asymmetric_damper", {220.0}},
                                                                        {"stribeck_friction", {40.0, 0.8, 0.03}},
                                                                        {"bouc_wen", {60e3, 50.0, 0.3}},
                                                                        {"position_ripple", {4e-3, 20.0, -15.0}}};
  for (const auto& [name, values] : hidden) {
    SCOPED_TRACE(name);
    Bench bench(sample::with_effect(sample::bench(), name.c_str(), values), 16.0);
    const SearchResult found = select_model(bench.problem, bench.space, {});
    ASSERT_FALSE(found.best.effects.empty());
    EXPECT_EQ(found.best.effects.size(), 1U) << found.best.effects.back().entry->name << " beside it";
    ASSERT_EQ(found.best.effects[0].entry->name, name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_NEAR(found.best.effects[0].values[i] / values[i], 1.0, 0.1) << i;
    }
  }
}

// Law. Of all candidates the hidden one is the best and leaves noise; without it, the model is as it was; the fit that
// is no longer needed gives back its Jacobian.
TEST(ModelFitter, FindsTheHiddenEffectFirst) {
  Bench bench(sample::with_effect(sample::bench(), "coulomb_friction", {40.0}));
  const SelectionCriterion criterion;
  const ModelFitter fitter(bench.problem, bench.space.common, criterion);
  const CandidateModel nothing = fitter.refitted(bench.given, {});
  EXPECT_FALSE(fitter.leaves_noise(nothing));
  const Scales scales = scales_of(bench.problem.samples(), bench.given, read_all(bench.problem, bench.given));
  const auto list = fitter.extended(nothing, scales, 4);
  ASSERT_FALSE(list.empty());
  EXPECT_LE(list.size(), 4U);
  EXPECT_EQ(list[0].effects[0].entry->name, "coulomb_friction");
  EXPECT_NEAR(list[0].effects[0].values[0], 40.0, 0.8);  // σ_F/√6000 = 0.13 N
  EXPECT_TRUE(fitter.leaves_noise(list[0]));
  EXPECT_EQ(list[0].fit.jacobian.size(), 0);
  EXPECT_GT(bench.problem.work().simulations(), 0U);
  EXPECT_GT(bench.problem.work().candidates(), 4U);
  const CandidateModel without = fitter.without(list[0], 0);
  EXPECT_TRUE(without.effects.empty());
  EXPECT_NEAR(without.fit.chi_squared / nothing.fit.chi_squared, 1.0, 1e-3);
  CandidateModel grown = list[0];
  fitter.refit_by_continuation(grown);
  EXPECT_LE(grown.fit.chi_squared, list[0].fit.chi_squared);
}

// Law. A force that is proportional to numbers of either sign is scanned at its best size, however far its start is
// from that, and with all of them together: of a ripple 40 times its start the scan promises what the fit then gains,
// and its fit begins there. Bounds: four standard errors, σ_F √(2/12000) = 0.13 N, and 1 % of what the period, found to
// a thirty-second of one, is off at the ends of the stroke.
TEST(ModelFitter, ScansWhatIsProportionalAtItsBestSize) {
  Bench bench(sample::with_effect(sample::bench(), "position_ripple", {4e-3, 60.0, -45.0}), 16.0);
  const SelectionCriterion criterion;
  const ModelFitter fitter(bench.problem, bench.space.common, criterion);
  const CandidateModel nothing = fitter.refitted(bench.given, {});
  const Scales scales = scales_of(bench.problem.samples(), bench.given, read_all(bench.problem, bench.given));
  const auto list = fitter.extended(nothing, scales, 1);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].effects[0].entry->name, "position_ripple");
  EXPECT_NEAR(list[0].effects[0].values[1], 60.0, 1.2);
  EXPECT_NEAR(list[0].effects[0].values[2], -45.0, 1.2);
  EXPECT_TRUE(fitter.leaves_noise(list[0]));
}

// Point. r = (3, −4, 1), directions along the first two axes and a third that the fit's own parameter does: sizes −3
// and 4 are taken off, the third keeps 0 and stays finite.
TEST(LinearRefit, FindsTheBestSizesTogether) {
  Fit base;
  base.residual = Eigen::Vector3d(3.0, -4.0, 1.0);
  base.jacobian = Eigen::Vector3d(0.0, 0.0, 1.0);
  base.parameters.resize(1);
  base.parameters[0].role = FreeParameter::Role::start;
  base.parameters[0].scale = 1.0;
  base.parameters[0].lower = -10.0;
  base.parameters[0].upper = 10.0;
  base.hypothesis.starts.resize(1);
  const LinearRefit refit(base);
  const Eigen::Matrix3d d = Eigen::Matrix3d::Identity();
  const Eigen::VectorXd sizes = refit.best_sizes(d);
  EXPECT_NEAR(sizes[0], -3.0, 1e-6);
  EXPECT_NEAR(sizes[1], 4.0, 1e-6);
  EXPECT_EQ(sizes[2], 0.0);
}

// Point. Where a late sensor and a late machine do the same, the machine is the cause: 10 to 1.
TEST(SelectionCriterion, TakesALateMachineForALateSensor) {
  const SelectionCriterion criterion;
  CandidateModel sensor = model_with(1500.0, 0), machine = model_with(1500.0, 0);
  sensor.effects.push_back({firmware::find_effect("sensor_lag"), Channel::x_act, {0.2}});
  machine.effects.push_back({firmware::find_effect("actuator_lag"), std::nullopt, {0.2}});
  EXPECT_TRUE(criterion.prefers(machine, sensor));
  EXPECT_NEAR(sensor.penalised_chi_squared(criterion) - machine.penalised_chi_squared(criterion), 2.0 * std::log(10.0),
              0.01);
}

// Journey. Free play that is found last was a guess when its knocks were looked for: of 1900 of them 370 were left out.
// In the end they are those of the gap that was found, up to the few that a last refit moves.
TEST(SelectModel, LeavesOutTheKnocksOfTheGapItFound) {
  const truth::Truth truth = truth::draw_rough("noise_coloured", 2026122803);
  std::vector<Record> records;
  records.push_back(
      {firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv"), Use::shared});
  Identified found = identify(firmware::parse_rig(truth::rig_toml(truth), "rig.toml"), std::move(records), {});
  const auto knocks = [&] {
    double count = 0.0;
    for (const auto& of_channel : found.problem.samples()[0].knocks) count += static_cast<double>(of_channel.size());
    return count;
  };
  const double left_out = knocks();
  ASSERT_GT(left_out, 0.0);
  found.problem.update_input_noise(found.found.best.fit.hypothesis);
  EXPECT_NEAR(left_out / knocks(), 1.0, 0.05);
}

// Journey. The search names what is hidden, with rivals that are further away, and nothing where nothing is hidden.
TEST(SelectModel, NamesWhatIsHiddenAndNothingElse) {
  Bench friction(sample::with_effect(sample::bench(), "coulomb_friction", {40.0}));
  std::vector<double> shares;
  const SearchResult found =
      select_model(friction.problem, friction.space,
                   [&](double share, const std::string&, std::size_t, std::size_t) { shares.push_back(share); });
  ASSERT_EQ(found.best.effects.size(), 1U);
  EXPECT_EQ(found.best.effects[0].entry->name, "coulomb_friction");
  EXPECT_GT(found.causes[0].gain, 1000.0);
  const SelectionCriterion criterion;
  for (const Rival& rival : found.causes[0].rivals) {
    EXPECT_GT(rival.penalised_chi_squared, found.best.penalised_chi_squared(criterion));
  }
  EXPECT_GE(shares.size(), 3U);
  Bench nothing(sample::bench());
  EXPECT_TRUE(select_model(nothing.problem, nothing.space, {}).best.effects.empty());
}

// Point. Of 8 s with 6 fitted, 3 s are half; a part of more than three quarters is the whole.
TEST(Search, TakesAPartOfTheWindowsWhereThatSavesWork) {
  const Bench bench(sample::bench());
  EXPECT_DOUBLE_EQ(share_with(bench.problem, 3.0), 0.5);
  EXPECT_EQ(share_with(bench.problem, 5.0), 1.0);
}

// Law. What was found on a part is refitted on the whole: χ² and the distance of rivals grow with the residuals.
TEST(Search, RefitsOnTheWholeWhatAPartShowed) {
  Bench bench(sample::with_effect(sample::bench(), "coulomb_friction", {40.0}));
  IdentificationProblem part = bench.problem.truncated(0.5);
  const SearchOptions options{{}, false, {}};
  SearchResult found = search(part, bench.space, options);
  compare(part, bench.space, options, found);
  ASSERT_EQ(found.best.effects.size(), 1U);
  const double before = found.best.fit.chi_squared, gain = found.causes[0].gain;
  ASSERT_FALSE(found.causes[0].rivals.empty());
  const auto distance = [&] {
    return found.causes[0].rivals[0].penalised_chi_squared - found.best.penalised_chi_squared(options.criterion);
  };
  const double apart = distance();
  refit_on(bench.problem, bench.space, options.criterion, found);
  EXPECT_NEAR(distance() / apart, 2.0, 0.05);
  EXPECT_NEAR(found.best.fit.chi_squared / before, 2.0, 0.15);
  EXPECT_NEAR(found.causes[0].gain / gain, 2.0, 0.05);
}

// Law. Where a model leaves nothing but noise, allowing for an error finds nothing better; the problem is left as it
// was.
TEST(SearchUnderModelError, ReplacesNothingThatIsTheWhole) {
  Bench bench(sample::bench());
  SearchResult found = search(bench.problem, bench.space, {});
  const double before = residuals(bench.problem, predict(bench.problem, bench.given)).squaredNorm();
  EXPECT_FALSE(search_under_model_error(bench.problem, bench.space, {}, found));
  EXPECT_TRUE(found.best.effects.empty());
  EXPECT_EQ(residuals(bench.problem, predict(bench.problem, bench.given)).squaredNorm(), before);
}

}  // namespace
