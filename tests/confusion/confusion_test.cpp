// What the confusion matrix calls right, and what worse. That the matrix is good itself is what rigtwin_confusion says.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/confusion/black_box.hpp"
#include "tests/confusion/golden.hpp"
#include "tests/confusion/laws.hpp"
#include "tests/confusion/plan.hpp"
#include "tests/confusion/rough.hpp"
#include "tests/confusion/table.hpp"

namespace {

using namespace confusion;
using host_sim::identification::Diagnosis;
using host_sim::identification::NamedEffect;
using host_sim::identification::Verdict;
using model::Channel;

NamedEffect named(const char* effect, std::optional<Channel> channel, double value, double confidence) {
  return {{firmware::find_effect(effect), channel, {value}}, {{value, 0.99 * value, 1.01 * value}}, confidence, {}};
}

truth::Truth gain_of_force() {
  truth::Truth truth;
  truth.effects = {{"sensor_gain", "F", {{"gain", 1.10}}}};
  truth.actual = {{"suspension.stiffness", 30e3}};
  return truth;
}

// Point. The rules for a right answer, one by one.
TEST(Confusion, KnowsWhatIsRight) {
  const Asked single{"single:hil:sensor_gain:F"}, none{"none:hil"}, unknown{"unknown:hil:hysteresis"};
  Diagnosis d;
  d.verdict = Verdict::named;
  d.effects = {named("sensor_gain", Channel::F, 1.105, 0.99)};
  d.parameters = {{"suspension.stiffness", {30.1e3, 30.05e3, 30.2e3}}};
  d.prediction_errors = {{Channel::F, {0.2, 0.2, 0.012, 0.010}}, {Channel::x_act, {0.2, 0.2, 0.01, 0.010}}};
  const Outcome right = judged(single, gain_of_force(), d);
  EXPECT_TRUE(right.right());
  ASSERT_EQ(right.estimates.size(), 2U);
  EXPECT_NEAR(right.estimates[0].error, 0.05, 1e-12);  // 0.005 of gain − 1 = 0.1
  EXPECT_TRUE(right.estimates[0].held);
  EXPECT_NEAR(right.estimates[1].error, 1.0 / 300.0, 1e-12);
  EXPECT_FALSE(right.estimates[1].held);
  EXPECT_NEAR(right.gap, 1.2, 1e-12);
  EXPECT_EQ(right.gap_channel, "F");

  d.verdict = Verdict::ambiguous;
  EXPECT_TRUE(judged(single, gain_of_force(), d).right());
  d.verdict = Verdict::unexplained;
  EXPECT_FALSE(judged(single, gain_of_force(), d).right());
  d.verdict = Verdict::named;
  d.effects.push_back(named("coulomb_friction", std::nullopt, 30.0, 0.4));
  EXPECT_FALSE(judged(single, gain_of_force(), d).right()) << "one too many";
  EXPECT_EQ(judged(single, gain_of_force(), d).effects_found(), 1U);
  EXPECT_FALSE(judged(single, gain_of_force(), d).wrong_name()) << "with little confidence";
  d.effects = {named("sensor_gain", Channel::x_act, 1.1, 0.99)};
  EXPECT_FALSE(judged(single, gain_of_force(), d).right()) << "another channel";
  EXPECT_TRUE(judged(single, gain_of_force(), d).wrong_name());

  truth::Truth strange;
  strange.unknown = "hysteresis";
  EXPECT_FALSE(judged(unknown, strange, d).right()) << "not flagged";
  d.unexplained = true;
  EXPECT_FALSE(judged(unknown, strange, d).right()) << "flagged, and a wrong name above 0.5";
  d.effects[0].confidence = 0.5;
  EXPECT_TRUE(judged(unknown, strange, d).right());

  // A law learned where the hidden one acts is an answer; where an effect of the catalogue hides it is a wrong name.
  d.unexplained = false;
  d.effects.clear();
  host_sim::identification::DescribedLaw law;
  law.shape = "power law";
  law.confidence = 0.9;
  d.laws = {law};
  strange.unknown_parameters = {{"cubic_damping", 1000.0}};
  EXPECT_TRUE(judged(unknown, strange, d).right());
  EXPECT_FALSE(judged(single, gain_of_force(), d).right());
  EXPECT_TRUE(judged(single, gain_of_force(), d).wrong_name());
  d.laws.front().law.place = host_sim::identification::CurvePlace::tyre;
  EXPECT_FALSE(judged(unknown, strange, d).right()) << "at another place";
  d.laws.clear();
  d.unexplained = true;

  // Spikes are outside the catalogue of effects, and outliers are a fault of the recording.
  const Asked spikes{"unknown:component_bench:spikes", 1};
  truth::Truth spiky;
  spiky.unknown = "spikes", spiky.unknown_channel = "F";
  Diagnosis said;
  said.recording_faults.push_back({"outliers", {Channel::x_act}, {}, 0.9});
  EXPECT_FALSE(judged(spikes, spiky, said).right()) << "another channel";
  said.recording_faults[0].channels = {Channel::F};
  EXPECT_TRUE(judged(spikes, spiky, said).right());

  EXPECT_FALSE(judged(none, {}, d).right());
  d = {};
  d.verdict = Verdict::no_discrepancy;
  EXPECT_TRUE(judged(none, {}, d).right());
}

// What travels through a pipe is what was sent, numbers that are none included.
TEST(Confusion, KeepsAnOutcomeThroughText) {
  Diagnosis d;
  d.verdict = Verdict::named;
  d.effects = {named("sensor_gain", Channel::F, 1.105, 0.99)};
  d.residual_power.after = NAN;
  d.residual = "F, 1 to 2 Hz";
  const Outcome sent = judged({"single:hil:sensor_gain:F", 7}, gain_of_force(), d);
  const Outcome come = outcome_from(nlohmann::ordered_json::parse(to_json(sent).dump()));
  EXPECT_EQ(to_json(come).dump(), to_json(sent).dump());
  EXPECT_TRUE(come.right());
  EXPECT_TRUE(std::isnan(come.residual_power));
}

// Law. At least 200 recordings, every group among them; the five parts are all of it, once, and each holds every
// category and every kind of rig.
TEST(Confusion, IsMadeOfFiveParts) {
  const auto all = plan(1);
  EXPECT_GE(all.size(), 200U);
  std::set<std::string> ids, groups;
  for (const Asked& asked : all) {
    EXPECT_TRUE(ids.insert(asked.id()).second) << asked.id();
    groups.insert(asked.group);
  }
  EXPECT_EQ(groups.size(), truth::groups().size());
  std::size_t together = 0;
  for (unsigned part = 1; part <= 5; ++part) {
    std::set<std::string> categories, kinds;
    const auto some = part_of(all, part, 5);
    for (const Asked& asked : some) {
      EXPECT_EQ(ids.erase(asked.id()), 1U);
      categories.insert(asked.what());
      const auto after = asked.group.find(':') + 1;
      kinds.insert(asked.group.substr(after, asked.group.find(':', after) - after));
    }
    together += some.size();
    EXPECT_EQ(categories.size(), 5U) << part;
    EXPECT_EQ(kinds.size(), 3U) << part;
  }
  EXPECT_EQ(together, all.size());
}

// The golden copy tells better from worse, category by category, and only over what both hold.
TEST(Confusion, NoticesWhatGotWorse) {
  Diagnosis nothing, found;
  nothing.verdict = Verdict::no_discrepancy;
  found.verdict = Verdict::named;
  found.effects = {named("sensor_gain", Channel::F, 1.1, 0.99)};
  const auto outcomes = [&](bool single, bool none) {
    return std::vector<Outcome>{judged({"single:hil:sensor_gain:F"}, gain_of_force(), single ? found : nothing),
                                judged({"none:hil"}, {}, none ? nothing : found)};
  };
  const auto golden = [&](const std::vector<Outcome>& list) {
    return golden_copy({}, "2026-01-01", table_of(list), list);
  };
  EXPECT_TRUE(regressions({}, outcomes(true, true), golden(outcomes(true, true))).empty());
  EXPECT_TRUE(regressions({}, outcomes(true, true), golden(outcomes(false, false))).empty());
  EXPECT_EQ(regressions({}, outcomes(false, true), golden(outcomes(true, true))).size(), 1U);
  EXPECT_EQ(regressions({}, outcomes(true, false), golden(outcomes(true, true))).size(), 2U) << "and a wrong name";
  EXPECT_EQ(regressions({}, outcomes(true, false), golden(outcomes(false, true))).size(), 2U) << "no trade";
  EXPECT_EQ(regressions({2, {}}, outcomes(true, true), golden(outcomes(true, true))).size(), 1U) << "another seed";
  EXPECT_EQ(regressions({}, outcomes(true, true), golden({})).size(), 1U) << "nothing in common";
  EXPECT_TRUE(shortfalls(table_of(outcomes(true, true))).empty());
  EXPECT_EQ(shortfalls(table_of(outcomes(false, true))).size(), 1U);
  EXPECT_FALSE(text(table_of(outcomes(false, true)), outcomes(false, true)).empty());
}

// Point. Rough conditions: a parameter that is off must be named, an invented fault is a wrong name, and what is near a
// law of the catalogue must be flagged.
TEST(Confusion, KnowsWhatIsRightOnRoughRigs) {
  truth::Truth truth;
  truth.rough.condition = "parameters_off";
  truth.rough.off = {"suspension.damping"};
  truth.nominal = {{"suspension.damping", 1000.0}};
  truth.actual = {{"suspension.damping", 1100.0}};
  const Asked asked{"rough:parameters_off", 7};
  const auto outcome = [&](const Diagnosis& d) {
    Outcome o = judged(asked, truth, d);
    judge_rough(o, truth, d);
    return o;
  };
  Diagnosis d;
  d.verdict = Verdict::named;
  EXPECT_FALSE(outcome(d).right());
  d.parameters_off = {{"suspension.damping", 1000.0, 0.03, {1099.0, 1090.0, 1110.0}, 0.9, {}}};
  EXPECT_TRUE(outcome(d).right());
  EXPECT_TRUE(outcome_from(nlohmann::ordered_json::parse(to_json(outcome(d)).dump())).right());
  d.parameters_off.push_back({"body.mass", 300.0, 0.03, {330.0, 329.0, 331.0}, 0.9, {}});
  EXPECT_FALSE(outcome(d).right());
  EXPECT_TRUE(outcome(d).wrong_rough);
  d.parameters_off.clear();
  d.effects = {named("viscous_damping", std::nullopt, 100.0, 0.9)};
  EXPECT_TRUE(outcome(d).right()) << "another name of the same";
  d.effects = {named("coulomb_friction", std::nullopt, 10.0, 0.9)};
  EXPECT_FALSE(outcome(d).right());

  truth.rough = {};
  truth.rough.condition = "daq";
  truth.rough.faults = {{{"clock_offset"}, {"F"}, {{"seconds", 2e-3}}}};
  d = {};
  d.verdict = Verdict::named;
  d.recording_faults = {{"clock_offset", {Channel::x_act}, {{"seconds", {-2.1e-3, -2.2e-3, -2.0e-3}}}, 0.9}};
  EXPECT_TRUE(outcome(d).right());
  EXPECT_EQ(outcome(d).faults_found, 1U);
  d.recording_faults[0].parameters["seconds"] = {8e-3, 7e-3, 9e-3};
  EXPECT_EQ(outcome(d).faults_found, 0U);
  d.recording_faults.push_back({"event", {}, {}, 0.9});
  EXPECT_TRUE(outcome(d).wrong_rough);

  truth.rough = {};
  truth.rough.condition = "neighbour_laws";
  truth.unknown = "a power of velocity";
  d = {};
  d.verdict = Verdict::named;
  EXPECT_FALSE(outcome(d).right());
  d.unexplained = true;
  d.effects = {named("quadratic_damping", std::nullopt, 100.0, 0.4)};
  EXPECT_TRUE(outcome(d).right());
  d.effects[0].confidence = 0.6;
  EXPECT_FALSE(outcome(d).right());
  // A law that the catalogue holds under another name is right by that name.
  truth.unknown_parameters = {{"stribeck_force", 30.0}};
  d = {};
  d.verdict = Verdict::named;
  d.effects = {named("stribeck_friction", std::nullopt, 30.0, 0.9)};
  EXPECT_TRUE(outcome(d).right());
  d.effects[0] = named("coulomb_friction", std::nullopt, 30.0, 0.9);
  EXPECT_FALSE(outcome(d).right());
  EXPECT_EQ(rough_plan(1, 3, "").size(), 3 * truth::conditions().size());
  EXPECT_NE(rough_text({outcome(d)}).find("parameters_off"), std::string::npos);
}

// Point. A law is recognised by any of its names alone; an exponent counts where one hides; a rig without a law must
// not get one. Soft friction is dry friction where no channel's error tells them apart.
TEST(Confusion, KnowsWhatIsRightOfLaws) {
  truth::Truth truth;
  truth.unknown = "a power";
  truth.unknown_parameters = {{"power", 400.0}, {"exponent", 1.5}};
  const auto outcome = [&](const char* group, const Diagnosis& d) {
    const Asked asked{group, 7};
    Outcome o = judged(asked, truth, d);
    judge_law(o, truth, d);
    return o;
  };
  host_sim::identification::DescribedLaw law;
  law.shape = "power law";
  law.confidence = 0.9;
  law.numbers = {{"exponent", 1.53, 1.5, 1.56}};
  Diagnosis d;
  d.verdict = Verdict::named;
  d.laws = {law};
  const char* power = "law:hil:power_law_low";
  EXPECT_TRUE(outcome(power, d).right());
  EXPECT_NEAR(outcome(power, d).exponent_error, 0.03, 1e-12);
  const Outcome again = outcome_from(nlohmann::ordered_json::parse(to_json(outcome(power, d)).dump()));
  EXPECT_TRUE(again.right());
  EXPECT_NEAR(again.exponent_error, 0.03, 1e-12);
  Outcome diverged = outcome(power, d);
  diverged.errors_of_force = {{"black box", INFINITY}, {"law", 0.02}};
  const auto through_text = outcome_from(nlohmann::ordered_json::parse(to_json(diverged).dump())).errors_of_force;
  EXPECT_FALSE(std::isfinite(through_text.at("black box")));
  EXPECT_EQ(through_text.at("law"), 0.02);
  d.effects = {named("quadratic_damping", std::nullopt, 100.0, 0.9)};
  EXPECT_FALSE(outcome(power, d).right()) << "and another name";
  d.laws.clear();
  EXPECT_TRUE(outcome(power, d).wrong_law);

  d.effects = {named("bouc_wen", std::nullopt, 100.0, 0.9)};
  EXPECT_TRUE(outcome("law:hil:hysteresis", d).right());
  EXPECT_FALSE(outcome("law:hil:iwan", d).right());
  d.effects = {named("coulomb_friction", std::nullopt, 100.0, 0.9)};
  EXPECT_TRUE(outcome("law:hil:smooth_friction", d).right());
  d.prediction_errors = {{Channel::F, {}}};
  d.prediction_errors.begin()->second.after = 0.3;
  d.prediction_errors.begin()->second.noise_floor = 0.2;
  EXPECT_FALSE(outcome("law:hil:smooth_friction", d).right()) << "1.5 times the floor";

  d.laws = {law};
  EXPECT_TRUE(outcome("none:hil", d).wrong_law);
  d.laws.clear();
  EXPECT_FALSE(outcome("none:hil", d).wrong_law);
  EXPECT_EQ(laws_plan(1, 2).size(), 3 * (18 * 2 + 2 + 9));
  EXPECT_NE(laws_text({outcome("law:hil:iwan", d)}).find("with memory"), std::string::npos);
}

// Point. A black box finds a recursion of its own terms exactly, up to rounding, and leaves what is none of them.
TEST(Confusion, ABlackBoxFindsItsOwnTerms) {
  const auto error = [](double friction) {
    firmware::Recording bench;
    std::vector<double>&x = bench[Channel::x_act], &force = bench[Channel::F];
    for (std::size_t k = 0; k < 20000; ++k) {
      const double t = 1e-3 * static_cast<double>(k);
      x.push_back(8e-3 * std::sin(9.0 * t) + 5e-3 * std::sin(31.0 * t + 1.0) + 3e-3 * std::sin(4.1 * t * t));
      const double moved = k >= 5 ? x[k] - x[k - 5] : 0.0;
      force.push_back(3e4 * x[k] + 1e8 * x[k] * x[k] * x[k] + 2e5 * moved + 0.4 * (k >= 5 ? force[k - 5] : 0.0) +
                      friction * (moved > 0.0 ? 1.0 : -1.0));
    }
    return BlackBox(bench).error();
  };
  EXPECT_LT(error(0.0), 1e-6);
  EXPECT_GT(error(200.0), 0.02);
}

}  // namespace
