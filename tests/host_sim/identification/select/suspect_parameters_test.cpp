// Descriptions that are not true: a parameter is the answer where a parameter is wrong. The recordings come from
// tests/truth, which shares no code with the model.
#include "host_sim/identification/select/suspect_parameters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "tests/host_sim/identification/faulty_recording.hpp"
#include "tests/support/report_page.hpp"
#include "tests/truth/truth.hpp"

namespace {

using host_sim::identification::Alternative;
using host_sim::identification::Diagnosis;
using host_sim::identification::FreeParameter;
using host_sim::identification::ParameterValue;
using host_sim::identification::SearchSpace;
using host_sim::identification::Verdict;

truth::Truth short_truth(const std::string& group, std::uint64_t seed) {
  truth::Truth truth = truth::draw(group, seed);
  truth.records.resize(1);
  truth.records[0].duration = 12.0;
  truth.records[0].warm = 0.0;
  return truth;
}

Diagnosis diagnosis_of(const truth::Truth& truth) {
  return host_sim::identification::diagnose(
      firmware::parse_rig(truth::rig_toml(truth), "rig.toml"),
      {{firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv"),
        host_sim::identification::Use::shared}});
}

// Point. Without a tolerance a described value is exact to its rounding: a spring 0.3 % stiffer is fitted, and as
// described though 2 N of noise show it; one 1 % stiffer is off.
TEST(SuspectParameters, AnswerBeyondTheRoundingOfADescription) {
  for (const double share : {0.003, 0.01}) {
    truth::Truth truth = short_truth("none:component_bench", 21);
    truth.tolerance.clear();
    truth.actual = truth.nominal;
    truth.noise["F"] = 2.0;
    truth.actual["suspension.stiffness"] = (1.0 + share) * truth.nominal["suspension.stiffness"];
    const Diagnosis found = diagnosis_of(truth);
    EXPECT_TRUE(found.effects.empty()) << host_sim::identification::sentence(found);
    EXPECT_FALSE(found.unexplained) << share << host_sim::identification::sentence(found);
    EXPECT_EQ(found.parameters_off.empty(), share < 0.005) << host_sim::identification::sentence(found);
    const auto fitted = found.parameters.find("suspension.stiffness");
    ASSERT_NE(fitted, found.parameters.end());
    EXPECT_LE(fitted->second.lower, truth.actual["suspension.stiffness"]);
    EXPECT_GE(fitted->second.upper, truth.actual["suspension.stiffness"]);
  }
}

// A car whose body is 10 kg lighter than described, without any tolerance: the mass is the answer, with its value, and
// no effect is dressed up. Tolerance of the value: four times its own interval, which the noise makes.
TEST(SuspectParameters, NameAMassThatIsNotAsDescribed) {
  truth::Truth truth = short_truth("none:quarter_car", 21);
  truth.tolerance.clear();
  truth.actual = truth.nominal;
  truth.actual["body.mass"] = truth.nominal["body.mass"] - 10.0;
  const Diagnosis found = diagnosis_of(truth);
  EXPECT_EQ(found.verdict, Verdict::named) << host_sim::identification::sentence(found);
  EXPECT_TRUE(found.effects.empty());
  EXPECT_FALSE(found.unexplained);
  ASSERT_EQ(found.parameters_off.size(), 1U);
  const auto& off = found.parameters_off[0];
  EXPECT_EQ(off.path, "body.mass");
  EXPECT_EQ(off.described, truth.nominal["body.mass"]);
  EXPECT_EQ(off.tolerance, 0.0);
  EXPECT_NEAR(off.value.value, truth.actual["body.mass"], 2.0 * (off.value.upper - off.value.lower));
  EXPECT_LT(off.value.upper - off.value.lower, 1.0);
  EXPECT_GT(off.confidence, 0.9);
  // What was found is the rig that other commands take.
  EXPECT_NEAR(found.rig.rig.body.mass, truth.actual["body.mass"], 1.0);

  const auto json = host_sim::identification::to_json(found);
  ASSERT_EQ(json["parameters_off"].size(), 1U);
  EXPECT_EQ(json["parameters_off"][0]["path"], "body.mass");
  EXPECT_EQ(json["parameters_off"][0]["ci95"].size(), 2U);
  const std::string page =
      host_sim::identification::report_html(found, firmware::parse_rig(truth::rig_toml(truth), "rig.toml"));
  EXPECT_NE(page.find("Parameters that are not as described"), std::string::npos);
}

// A spring 10 % stiffer than its tolerance of 3 % allows; before, a bump stop with a clearance of micrometres.
TEST(SuspectParameters, NameAStiffnessBeyondItsTolerance) {
  truth::Truth truth = short_truth("none:quarter_car", 22);
  truth.actual["suspension.stiffness"] = 1.10 * truth.nominal["suspension.stiffness"];
  truth.tolerance["suspension.stiffness"] = 0.03;
  const Diagnosis found = diagnosis_of(truth);
  EXPECT_EQ(found.verdict, Verdict::named) << host_sim::identification::sentence(found);
  ASSERT_EQ(found.parameters_off.size(), 1U);
  EXPECT_EQ(found.parameters_off[0].path, "suspension.stiffness");
  EXPECT_NEAR(found.parameters_off[0].value.value / truth.actual["suspension.stiffness"], 1.0, 2e-3);
  EXPECT_TRUE(found.effects.empty());
}

// A tyre 8 % softer beside tolerances of 3 %: every single effect leaves 80 times the noise in zdd_w, so that the
// search under model error was next, and a law at the tyre was learned.
TEST(SuspectParameters, ExplainWhatEffectsDoNotEvenComeNear) {
  truth::Truth truth = short_truth("none:quarter_car", 26);
  truth.actual["tyre.stiffness"] = 0.92 * truth.nominal["tyre.stiffness"];
  truth.tolerance["tyre.stiffness"] = 0.03;
  for (auto& [channel, noise] : truth.noise) noise *= 0.3;
  const Diagnosis found = diagnosis_of(truth);
  EXPECT_EQ(found.verdict, Verdict::named) << host_sim::identification::sentence(found);
  EXPECT_TRUE(found.effects.empty() && found.laws.empty()) << host_sim::identification::sentence(found);
  ASSERT_EQ(found.parameters_off.size(), 1U);
  EXPECT_EQ(found.parameters_off[0].path, "tyre.stiffness");
  EXPECT_NEAR(found.parameters_off[0].value.value / truth.actual["tyre.stiffness"], 1.0, 2e-3);
}

// A duct 8 % longer, of a bench without tolerances for length, diameter and area: these and the density of the oil are
// nearly one number, the inertia of the oil. Each is a rival of the others, and takes its share of the confidence: with
// odds o against one rival it is 1/(1 + 1/o) at most.
TEST(SuspectParameters, HaveOtherParametersAsRivals) {
  std::uint64_t seed = 27;
  truth::Truth truth = short_truth("none:component_bench", seed);
  while (!truth.fdva) truth = short_truth("none:component_bench", ++seed);
  truth.actual["fdva.duct_length"] = 1.08 * truth.nominal["fdva.duct_length"];
  const Diagnosis found = diagnosis_of(truth);
  EXPECT_EQ(found.verdict, Verdict::ambiguous) << host_sim::identification::sentence(found);
  ASSERT_EQ(found.parameters_off.size(), 1U) << host_sim::identification::sentence(found);
  const auto& off = found.parameters_off[0];
  std::vector<ParameterValue> others;
  for (const Alternative& other : off.alternatives) {
    EXPECT_LE(off.confidence, 1.0 / (1.0 + 1.0 / other.odds_against));
    if (const auto* const parameter = std::get_if<ParameterValue>(&other.cause)) others.push_back(*parameter);
  }
  ASSERT_GE(others.size(), 2U);
  std::vector<std::string> paths{off.path};
  for (const ParameterValue& other : others) paths.push_back(other.path);
  EXPECT_TRUE(std::find(paths.begin(), paths.end(), "fdva.duct_length") != paths.end());
  // Named in the sentence, in verdict.json among the alternatives with its value, and in the report.
  const std::string& second = others.front().path;
  EXPECT_NE(host_sim::identification::sentence(found).find("(or " + second), std::string::npos);
  const auto json = host_sim::identification::to_json(found);
  EXPECT_EQ(json["parameters_off"][0]["alternatives"][0]["name"], second);
  EXPECT_EQ(json["parameters_off"][0]["alternatives"][0]["value"], others.front().value);
  const std::string page =
      host_sim::identification::report_html(found, firmware::parse_rig(truth::rig_toml(truth), "rig.toml"));
  EXPECT_NE(page.find(second + " of "), std::string::npos);
}

// A damping that is off and a delayed sensor: both are found, each as what it is.
TEST(SuspectParameters, StandBesideAnEffect) {
  truth::Truth truth = short_truth("single:quarter_car:sensor_delay:dz_b", 23);
  truth.actual["suspension.damping"] = 0.7 * truth.nominal["suspension.damping"];
  const Diagnosis found = diagnosis_of(truth);
  ASSERT_EQ(found.parameters_off.size(), 1U) << host_sim::identification::sentence(found);
  EXPECT_EQ(found.parameters_off[0].path, "suspension.damping");
  EXPECT_NEAR(found.parameters_off[0].value.value / truth.actual["suspension.damping"], 1.0, 0.01);
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].effect.entry->name, "sensor_delay");
}

// More damping than the tolerance allows is what viscous_damping is: the catalogue's name stands, as before.
TEST(SuspectParameters, LeaveAnEffectItsName) {
  const Diagnosis found = diagnosis_of(short_truth("single:quarter_car:viscous_damping", 24));
  ASSERT_EQ(found.effects.size(), 1U) << host_sim::identification::sentence(found);
  EXPECT_EQ(found.effects[0].effect.entry->name, "viscous_damping");
  EXPECT_TRUE(found.parameters_off.empty());
}

// A freed parameter takes the place of its tolerated self, or stands behind the tolerated ones and before the starts.
TEST(SuspectParameters, KeepTheOrderOfASearchSpace) {
  SearchSpace space;
  const auto parameter = [](FreeParameter::Role role, const char* path, double upper) {
    FreeParameter p{.role = role, .path = path};
    p.upper = upper;
    return p;
  };
  using enum FreeParameter::Role;
  space.tolerated = {parameter(tolerated, "a", 1.0), parameter(tolerated, "b", 1.0)};
  space.common = space.tolerated;
  space.common.push_back(parameter(start, "", 1.0));
  const SearchSpace freed =
      host_sim::identification::untied(space, {parameter(tolerated, "b", 9.0), parameter(tolerated, "c", 9.0)});
  ASSERT_EQ(freed.tolerated.size(), 3U);
  EXPECT_EQ(freed.tolerated[1].upper, 9.0);
  EXPECT_EQ(freed.tolerated[2].path, "c");
  ASSERT_EQ(freed.common.size(), 4U);
  EXPECT_EQ(freed.common[0].upper, 1.0);
  EXPECT_EQ(freed.common[1].upper, 9.0);
  EXPECT_EQ(freed.common[2].path, "c");
  EXPECT_EQ(freed.common[3].role, start);
}

// A channel that is held beside a mass that is not as described: the hold is seen in the values, and the mass needs no
// other effect.
TEST(SuspectParameters, StandBesideAHoldThatTheValuesShow) {
  truth::Truth truth = short_truth("single:quarter_car:sensor_hold", 23);
  ASSERT_EQ(truth.effects.size(), 1U);
  truth.tolerance.clear();
  truth.actual = truth.nominal;
  truth.actual["body.mass"] = 0.92 * truth.nominal["body.mass"];
  const Diagnosis found = diagnosis_of(truth);
  const std::string said = host_sim::identification::sentence(found);
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "sensor_hold") << said;
  ASSERT_EQ(found.parameters_off.size(), 1U) << said;
  EXPECT_EQ(found.parameters_off[0].path, "body.mass");
  EXPECT_NEAR(found.parameters_off[0].value.value / truth.actual["body.mass"], 1.0, 5e-3);
  EXPECT_GT(found.parameters_off[0].confidence, 0.5);
}

/// Diagnoses a rough recording of one effect and one parameter that is off: both are named, and nothing else. The value
/// is right within half a per cent, many times what noise does in 12 s.
void expect_one_of_each(std::uint64_t seed, const std::string& effect, const std::string& path) {
  truth::Truth truth = truth::draw_rough("parameters_off", seed);
  truth.records.resize(1);
  truth.records[0].duration = 12.0;
  ASSERT_EQ(truth.effects.size(), 1U);
  ASSERT_EQ(truth.rough.off, std::vector<std::string>{path});
  const Diagnosis found = diagnosis_of(truth);
  const std::string said = host_sim::identification::sentence(found);
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, effect) << said;
  ASSERT_EQ(found.parameters_off.size(), 1U) << said;
  EXPECT_EQ(found.parameters_off[0].path, path);
  EXPECT_NEAR(found.parameters_off[0].value.value / truth.actual.at(path), 1.0, 5e-3);
}

// A mass 14.6 % off beside a quadratic damping. Alone, another parameter explains more than the mass; only a search
// beside the mass finds the damping. Before: four effects and a rest.
TEST(SuspectParameters, AreEachTriedBesideEffects) { expect_one_of_each(401, "quadratic_damping", "body.mass"); }

// A stiffness 8.3 % off beside a lag. A relaxation within 100 s, the longest of its card, is that stiffness and costs
// 0.8 less than the parameter: it is not the answer.
TEST(SuspectParameters, AreNotALimitOfAnEffect) { expect_one_of_each(506, "sensor_lag", "suspension.stiffness"); }

// A stiffness 5.5 % off alone. A relaxation within 47 s is 12 of χ² better, of a million: less than the model's own
// step gets wrong.
TEST(SuspectParameters, TakeThePlaceOfALimitWithinTheErrorOfAStep) {
  const truth::Truth truth = truth::draw_rough("parameters_off", 2026120401);
  ASSERT_EQ(truth.rough.off, std::vector<std::string>{"suspension.stiffness"});
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_TRUE(found.effects.empty()) << said;
  ASSERT_EQ(found.parameters_off.size(), 1U) << said;
  EXPECT_EQ(found.parameters_off[0].path, "suspension.stiffness");
  EXPECT_NEAR(found.parameters_off[0].value.value / truth.actual.at("suspension.stiffness"), 1.0, 5e-4);
  EXPECT_GT(found.parameters_off[0].confidence, 0.5);
}

// A damping 25 % off beside a rate limit. A gain of F and a stop of no clearance do the same, and each of the two is
// cheaper than a parameter; damping and stiffness stand at the bounds of their tolerances then.
TEST(SuspectParameters, AreTriedInThePlaceOfTwoEffects) {
  expect_one_of_each(2026120202, "actuator_rate_limit", "suspension.damping");
}

// A spring 7.8 % too soft is a gain of F with a damper that gives back what the gain took, and no parameter stands at a
// bound then.
TEST(SuspectParameters, TakeThePlaceOfTwoEffects) {
  expect_one_of_each(2026121308, "actuator_resonance", "suspension.stiffness");
}

// Fault. Effects are searched again beside a parameter that is freed: the hold that the values show was part of the
// rig that this search was given, so nobody named it.
TEST(SuspectParameters, TakeNoHoldsNameAway) {
  const Diagnosis found = sample::diagnosis_of_all(truth::draw_rough("parameters_off", 2026121903));
  const std::string said = host_sim::identification::sentence(found);
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "sensor_hold") << said;
  EXPECT_EQ(found.effects[0].effect.channel, model::Channel::zdd_r) << said;
  ASSERT_EQ(found.parameters_off.size(), 1U) << said;
  EXPECT_EQ(found.parameters_off[0].path, "wheel.mass") << said;
}

}  // namespace
