// From the selected model to a verdict.
#include "host_sim/identification/assess/assess.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <variant>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/assess/localisation.hpp"
#include "host_sim/identification/assess/named_effect.hpp"
#include "host_sim/identification/assess/overlay.hpp"
#include "host_sim/identification/assess/prediction_error.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/thresholds.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

// Point. Without rivals and with a gain beside which nothing could hide, the confidence is the highest there is; even
// odds halve it; a gain that a law outside the catalogue could hide beside takes a fifth; a residual takes its share.
TEST(Confidence, FollowsItsEquation) {
  const Certainty certain{1.0, 1.0, 200.0, false};
  EXPECT_DOUBLE_EQ(confidence({}, 1e9, certain), thresholds::highest_confidence);
  EXPECT_DOUBLE_EQ(confidence({1.0}, 1e9, certain), 0.5 * thresholds::highest_confidence);
  EXPECT_DOUBLE_EQ(confidence({}, 200.0, certain), (1.0 - thresholds::outside_share) * thresholds::highest_confidence);
  // q = 0.1 of a gain of 2000 is seen: ln(100)/ln(1000) = 2/3 of the fifth.
  EXPECT_NEAR(confidence({}, 2000.0, certain),
              (1.0 - thresholds::outside_share * 2.0 / 3.0) * thresholds::highest_confidence, 1e-12);
  EXPECT_DOUBLE_EQ(confidence({}, 1e9, {0.4, 1.0, 200.0, false}), 0.4 * thresholds::highest_confidence);
  EXPECT_LT(confidence({}, 2000.0, {1.0, 5.0, 200.0, false}), confidence({}, 2000.0, certain)) << "χ² is worth a fifth";
}

// Law. That sensors are seldom late is known whatever a model leaves: of a machine and a sensor that explain the same,
// χ² of both sixteen times the noise's, the odds are those of the prior, 10 to 1. What χ² says counts a sixteenth.
TEST(Confidence, DoesNotTemperAPrior) {
  const firmware::CatalogueEntry* const lag = firmware::find_effect("sensor_lag");
  const firmware::CatalogueEntry* const delay = firmware::find_effect("actuator_delay");
  ASSERT_TRUE(lag != nullptr && delay != nullptr);
  const Rival late{{lag, Channel::x_act, {0.01}}, 1000.0 + thresholds::late_sensor, {}};
  const Rival worse{{delay, std::nullopt, {0.01}}, 1000.0 + 32.0, {}};
  const auto none = [](const Hypothesis&) { return std::string(); };
  const RatedRivals rivals = rated({late, worse}, 1000.0, 0.0, {}, 16.0, none);
  ASSERT_EQ(rivals.odds.size(), 2U);
  EXPECT_NEAR(rivals.odds[0], std::exp(0.5 * thresholds::late_sensor), 1e-9);
  EXPECT_NEAR(rivals.odds[1], std::exp(1.0), 1e-9);
  // And where the sensor was found first: the machine is then the more likely one.
  const Rival machine{{delay, std::nullopt, {0.01}}, 1000.0, {}};
  const double odds =
      rated({machine}, 1000.0 + thresholds::late_sensor, thresholds::late_sensor, {}, 16.0, none).odds[0];
  EXPECT_NEAR(odds, std::exp(-0.5 * thresholds::late_sensor), 1e-9);
}

// A law that could imitate others, beside a rest, is an imitation; another effect beside a rest is not.
TEST(Confidence, DoesNotBelieveAnImitationBesideARest) {
  const firmware::RigDescription bench = sample::bench();
  auto recordings = sample::prepared(bench, bench, Use::shared, 3.0);
  const Hypothesis given = described_hypothesis(bench, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  const auto confidence_of = [&](const char* name, std::vector<double> values, bool rest) {
    SearchResult found;
    found.best.effects = {{firmware::find_effect(name), std::nullopt, std::move(values)}};
    found.causes = {{.gain = 1e9}};
    std::vector<Interval> parameters;
    for (const double value : found.best.effects[0].values) parameters.push_back({value, 0.99 * value, 1.01 * value});
    return named_effects(problem, found, {}, parameters, {1.0, 1.0, 200.0, rest}).at(0).confidence;
  };
  // Far from the unloading of what looks like it.
  EXPECT_DOUBLE_EQ(confidence_of("bouc_wen", {1e5, 50.0, -1.0}, false), thresholds::highest_confidence);
  EXPECT_LT(confidence_of("bouc_wen", {1e5, 50.0, -1.0}, true), 0.5);
  EXPECT_DOUBLE_EQ(confidence_of("coulomb_friction", {50.0}, true), thresholds::highest_confidence);
}

// Bouc–Wen hysteresis that unloads as friction with bristles does may be that friction. By hand for an unloading of
// 0.8 and σ = 0.05: v = 0.0314, the density 2.2513, r = 3 · 0.25 · 2.2513; √v below that e^½ less.
TEST(Confidence, DoubtsALawThatAnotherOneLooksLike) {
  const auto law_at = [](double unloading, double sigma) {
    const firmware::PlacedEffect wen{firmware::find_effect("bouc_wen"), std::nullopt, {1e5, 50.0, unloading}};
    const double half = 1.96 * sigma;
    return lookalike_of(wen,
                        {{1e5, 0.9e5, 1.1e5}, {50.0, 49.0, 51.0}, {unloading, unloading - half, unloading + half}});
  };
  const auto odds_at = [&](double unloading, double sigma) {
    const double chance = law_at(unloading, sigma).chance;
    return chance / (1.0 - chance);
  };
  EXPECT_NEAR(odds_at(0.8, 0.05), 1.6885, 1e-4);
  EXPECT_NEAR(odds_at(0.8 - std::sqrt(0.0314), 0.05), 1.6885 * std::exp(-0.5), 1e-4);
  EXPECT_EQ(law_at(0.8, 0.05).law, "friction with bristles (Dahl, LuGre)");
  EXPECT_TRUE(is_close(law_at(0.4, 0.05))) << "odds of 1 to 7.6";
  EXPECT_FALSE(is_close(law_at(0.3, 0.05))) << "odds of 1 to 32";
  const firmware::PlacedEffect dry{firmware::find_effect("coulomb_friction"), std::nullopt, {50.0}};
  EXPECT_EQ(lookalike_of(dry, {{50.0, 49.0, 51.0}}).chance, 0.0);
}

// Beside dry friction twice the step changes the residuals: what gains less may be made by the steps, what gains
// twice as much is not. Without a corner nothing is simulated in finer steps.
TEST(Confidence, DoesNotBelieveWhatTheStepsMayMake) {
  const sample::Given car = sample::given("single:quarter_car:coulomb_friction", 1, {}, 4.0);
  std::vector<PreparedRecording> recordings{prepare_recording(car.description, car.recording, Use::shared, false)};
  const Hypothesis given = described_hypothesis(car.description, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  Hypothesis cornered = given;
  firmware::put_effect(cornered.rig, {firmware::find_effect("coulomb_friction"), std::nullopt, {60.0}});
  const auto confidence_of = [&](double gain, const Hypothesis& hypothesis) {
    SearchResult found;
    found.best.fit.hypothesis = hypothesis;
    found.best.effects = {{firmware::find_effect("viscous_damping"), std::nullopt, {1.0}}};
    found.causes = {{.gain = gain}};
    return named_effects(problem, found, {}, {Interval{1.0, 0.9, 1.1}}, {1.0, 1.0, 1e-6, false}).at(0).confidence;
  };
  const double steps =
      (residuals(problem, predict(problem, cornered, true)) - residuals(problem, predict(problem, cornered)))
          .squaredNorm();
  ASSERT_GT(steps, 0.0);
  EXPECT_LT(confidence_of(0.5 * steps, cornered), 0.5);
  EXPECT_GT(confidence_of(2.0 * steps, cornered), 0.5);
  EXPECT_GT(confidence_of(0.5 * steps, given), 0.5);
}

// Edge. Another minimum of an effect is no rival of it: it would take half of the confidence in its own name.
TEST(Confidence, DoesNotWeighAnEffectAgainstItself) {
  const sample::Given car = sample::given("none:quarter_car", 1, {}, 4.0);
  std::vector<PreparedRecording> recordings{prepare_recording(car.description, car.recording, Use::shared, false)};
  const Hypothesis given = described_hypothesis(car.description, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  SearchResult found;
  found.best.fit.hypothesis = given;
  found.best.effects = {{firmware::find_effect("viscous_damping"), std::nullopt, {100.0}}};
  found.causes = {{.gain = 1e4}};
  const double same = found.best.penalised_chi_squared({});
  found.causes[0].rivals = {{{firmware::find_effect("viscous_damping"), std::nullopt, {90.0}}, same, given},
                            {{firmware::find_effect("coulomb_friction"), std::nullopt, {90.0}}, same + 1e3, given}};
  const NamedEffect named =
      named_effects(problem, found, {}, {Interval{100.0, 90.0, 110.0}}, {1.0, 1.0, 1e-6, false}).at(0);
  EXPECT_GT(named.confidence, 0.99);
  ASSERT_EQ(named.alternatives.size(), 1U);
  EXPECT_EQ(std::get<firmware::PlacedEffect>(named.alternatives[0].cause).entry->name, "coulomb_friction");
}

// Point. Of 2600 residuals in 13 bands of 2 channels 200 are in two bands: 8 √400 = 160 against 15 % = 30.
TEST(Confidence, KnowsWhatWouldBeSeen) { EXPECT_DOUBLE_EQ(seen_from(2600.0, 2), 160.0); }

TEST(Confidence, CallsARivalCloseBelowOddsOfTwenty) {
  NamedEffect named{{}, {}, 0.9, {{{}, 19.0, ""}}};
  EXPECT_TRUE(has_close_rival(named.alternatives));
  named.alternatives[0].odds_against = 21.0;
  EXPECT_FALSE(has_close_rival(named.alternatives));
}

// Point. Two channels with 900 and 100 too much, of 100 residuals each: shares of 90 and 10 %, the larger first, each
// in the band of its excess. Where an effect of a sensor was found its channel is that sensor's; else the likely place
// counts.
TEST(Localisation, SharesTheExcessAmongChannels) {
  const auto band = [](Channel channel, double lowest, double highest, double squares) {
    return BandPower{channel, lowest, highest, {squares, 100.0}, 0.0, 0.0};
  };
  const std::vector<BandPower> left{band(Channel::x_act, 0.5, 1.0, 200.0), band(Channel::x_act, 1.0, 2.0, 100.0),
                                    band(Channel::F, 0.5, 1.0, 100.0), band(Channel::F, 1.0, 2.0, 1000.0)};
  SearchResult found;
  found.best.fit.hypothesis.rig = sample::bench().rig;
  auto locations = localise(left, found, "");
  ASSERT_EQ(locations.size(), 1U) << "100 of 100 residuals are 7 standard deviations";
  EXPECT_EQ(locations[0].channel, Channel::F);
  EXPECT_NEAR(locations[0].share, 0.9, 1e-12);
  EXPECT_EQ(locations[0].lowest, 1.0);
  EXPECT_EQ(locations[0].highest, 2.0);
  EXPECT_EQ(locations[0].subsystem, "suspension");
  EXPECT_EQ(localise(left, found, "machine")[0].subsystem, "machine");
  found.best.effects.push_back({firmware::find_effect("sensor_lag"), Channel::F, {1e-3}});
  EXPECT_EQ(localise(left, found, "machine")[0].subsystem, "sensor F");
}

Diagnosis diagnosis_of(const firmware::RigDescription& truth) {
  const firmware::RigDescription bench = sample::bench();
  auto recordings = sample::prepared(bench, truth, Use::shared, 12.0);
  const Hypothesis given = described_hypothesis(bench, recordings);
  IdentificationProblem problem(std::move(recordings), given);
  const SearchSpace space = search_space(bench, problem.samples(), given);
  std::vector<ParityResidual> relations = parity_residuals(bench, problem.samples());
  SearchResult found = select_model(problem, space, {});
  return assess(bench, problem, space, std::move(relations), std::move(found), {});
}

bool all_finite(const nlohmann::ordered_json& json) {
  if (json.is_number()) return std::isfinite(json.get<double>());
  if (json.is_null()) return false;
  for (const auto& [key, value] : json.items()) {
    if ((value.is_structured() || value.is_number() || value.is_null()) && !all_finite(value)) return false;
  }
  return true;
}

// Journey. Friction of a component: named, placed, its error down to the noise on data that was not fitted, in the rig
// that is left; and all of it in verdict.json with every key of the contract and finite numbers.
TEST(Assess, SaysWhatIsMissingAndHowSureThatIs) {
  const Diagnosis found = diagnosis_of(sample::with_effect(sample::bench(), "coulomb_friction", {40.0}));
  EXPECT_EQ(found.verdict, Verdict::named);
  EXPECT_EQ(name(found.verdict), "named");
  ASSERT_EQ(found.effects.size(), 1U);
  const Interval& force = found.effects[0].parameters[0];
  EXPECT_LT(force.lower, 40.0);
  EXPECT_GT(force.upper, 40.0);
  EXPECT_GT(found.effects[0].confidence, 0.9);
  ASSERT_FALSE(found.locations.empty());
  EXPECT_EQ(found.locations[0].channel, Channel::F);
  EXPECT_EQ(found.locations[0].subsystem, "suspension");
  const PredictionError& error = found.prediction_errors.at(Channel::F);
  EXPECT_GT(error.refit, 2.0 * error.after);
  EXPECT_NEAR(error.after / error.noise_floor, 1.0, 0.05);
  EXPECT_EQ(firmware::effects_of(found.rig.rig).size(), 1U);
  EXPECT_GT(found.residual_power.refit, 2.0);
  EXPECT_NEAR(found.residual_power.after, 1.0, 0.1);
  ASSERT_EQ(found.overlays.size(), 2U);
  EXPECT_EQ(found.overlays[1].frequency.size(), found.overlays[1].error_after.size());
  EXPECT_GT(found.overlays[1].frequency.front(), 0.0);
  EXPECT_LE(found.overlays[1].frequency.back(), 90.0);
  EXPECT_EQ(found.overlays[1].time.size(), 1500U);

  const auto json = to_json(found);
  for (const char* key : {"verdict", "where", "relations", "effects", "gap", "parameters", "unexplained",
                          "parameters_off", "recording", "laws", "undetermined", "unexplained_probability", "budget"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_TRUE(json.at("laws").is_array());
  EXPECT_TRUE(all_finite(json)) << json.dump(2);
  EXPECT_EQ(json.at("effects").at(0).at("name"), "coulomb_friction");
  EXPECT_TRUE(sentence(found).starts_with("The model lacks coulomb_friction")) << sentence(found);
  EXPECT_TRUE(result_rig(found.rig, found.rig, "given.toml").starts_with(result_rig_mark));
  EXPECT_NE(report_html(found, sample::bench()).find("coulomb_friction"), std::string::npos);
}

// Journey. Nothing but noise and a tolerated stiffness: no effect, no location, a relation for each pair of channels.
TEST(Assess, FindsNothingInARigAsDescribed) {
  firmware::RigDescription truth = sample::bench();
  truth.rig.suspension.stiffness *= 1.02;
  const Diagnosis found = diagnosis_of(truth);
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy);
  EXPECT_TRUE(found.effects.empty());
  EXPECT_TRUE(found.locations.empty());
  EXPECT_EQ(found.relations.size(), 2U);
  EXPECT_NEAR(found.parameters.at("suspension.stiffness").value, 30600.0, 60.0);
  const std::string card = explanation(*firmware::find_effect("bump_stop"));
  EXPECT_NE(card.find("clearance"), std::string::npos);
  EXPECT_EQ(odds_text(34.52), "34.5 to 1");
  EXPECT_EQ(unit_of({firmware::find_effect("sensor_offset"), Channel::F, {1.0}}, 0), "N");
}

/// Message of a writer about a number that is not finite.
template <class Write>
std::string refusal(const Write& write) {
  try {
    write();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "";
}

// Fault. What is not a number never leaves in verdict.json nor in rig.toml: it is a mistake of ours, exit status 5.
TEST(VerdictJson, HoldsFiniteNumbersOnly) {
  Diagnosis broken;
  broken.prediction_errors[Channel::F] = {0.1, 0.1, std::nan(""), 0.1};
  EXPECT_EQ(refusal([&] { (void)to_json(broken); }), "verdict.json: gap.F.after is not a finite number");
  broken.prediction_errors.clear();
  broken.parameters["suspension.stiffness"] = {1.0, -INFINITY, 2.0};
  EXPECT_EQ(refusal([&] { (void)to_json(broken); }),
            "verdict.json: parameters.suspension.stiffness.ci95.0 is not a finite number");
  firmware::RigDescription rig = sample::with_effect(sample::bench(), "coulomb_friction", {40.0});
  EXPECT_EQ(refusal([&] { (void)result_rig(rig, rig, "given.toml"); }), "");
  rig = sample::with_effect(sample::bench(), "coulomb_friction", {std::nan("")});
  EXPECT_EQ(refusal([&] { (void)result_rig(rig, rig, "given.toml"); }), "rig.toml: coulomb_friction is not finite");
  rig = sample::bench();
  rig.rig.suspension.damping = INFINITY;
  EXPECT_EQ(refusal([&] { (void)result_rig(rig, rig, "given.toml"); }), "rig.toml: suspension.damping is not finite");
}

// Fault. A candidate that explains what was fitted and diverges on what was held out is no answer: the verdict says
// that something is left, and every number of it is finite.
TEST(Assess, GivesUpAModelThatDiverges) {
  const firmware::RigDescription bench = sample::bench();
  auto recordings = sample::prepared(bench, sample::with_effect(bench, "coulomb_friction", {40.0}), Use::shared, 8.0);
  // The linear spring bears what ends the held-out part; a cubic one makes a force of it whose square is no number.
  recordings.front().input.motion.back().position = 1e80;
  const Hypothesis given = described_hypothesis(bench, recordings);
  IdentificationProblem problem(std::move(recordings), given);
  const SearchSpace space = search_space(bench, problem.samples(), given);
  SearchResult found = select_model(problem, space, {});
  const firmware::PlacedEffect spring{firmware::find_effect("progressive_spring"), std::nullopt, {-1e9}};
  firmware::put_effect(found.best.fit.hypothesis.rig, spring);
  ASSERT_FALSE(stays_finite(problem, found.best.fit.hypothesis));
  found.best.effects = {spring};
  const Diagnosis diagnosis = assess(bench, problem, space, {}, std::move(found), {});
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_TRUE(diagnosis.effects.empty());
  EXPECT_TRUE(all_finite(to_json(diagnosis)));
}

// Something pushes for a second, and nobody looks for events: verdict.json says in which second, and the report draws
// it.
TEST(Assess, SaysWhenTheDisagreementHappens) {
  const firmware::RigDescription bench = sample::bench();
  firmware::Recording pushed = sample::recorded(bench, 12.0);
  for (std::size_t k = 4000; k < 5000; ++k) pushed[Channel::F][k] += 60.0 * std::sin(0.08 * static_cast<double>(k));
  std::vector<PreparedRecording> recordings;
  recordings.push_back(prepare_recording(bench, std::move(pushed), Use::shared, false));
  const Hypothesis given = described_hypothesis(bench, recordings);
  IdentificationProblem problem(std::move(recordings), given);
  const SearchSpace space = search_space(bench, problem.samples(), given);
  const Diagnosis found = assess(bench, problem, space, {}, select_model(problem, space, {}), {});
  EXPECT_TRUE(found.unexplained);
  const auto json = to_json(found);
  ASSERT_FALSE(json.at("where").empty());
  const auto& place = json.at("where").at(0);
  EXPECT_EQ(place.at("channel"), "F");
  EXPECT_NEAR(place.at("time_s").at(0).get<double>(), 4.0, 0.6);
  EXPECT_NEAR(place.at("time_s").at(1).get<double>(), 5.0, 0.6);
  ASSERT_EQ(place.at("power_per_second").size(), 12U);
  ASSERT_EQ(place.at("seconds").size(), 12U);
  EXPECT_GT(place.at("power_per_second").at(4).get<double>(), 5.0);
  EXPECT_NEAR(place.at("power_per_second").at(8).get<double>(), 1.0, 0.5);
  EXPECT_NE(report_html(found, bench).find("second by second"), std::string::npos);
}

}  // namespace
