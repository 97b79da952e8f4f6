// Whole diagnoses of rigs with a law that the catalogue does not hold, made by the truth generator.
#include "host_sim/identification/learn/learn_laws.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace host_sim::identification;

Diagnosis diagnosed(const std::string& group, std::uint64_t seed, double seconds = 12.0) {
  sample::Given given = sample::given(group, seed, {}, seconds);
  return diagnose(given.description, {{std::move(given.recording), Use::shared}});
}

double hidden(const std::string& group, std::uint64_t seed, const char* value) {
  return nlohmann::json::parse(truth::truth_json(truth::draw(group, seed, {})))["unknown"]["spec"][value];
}

double number(const DescribedLaw& law, const std::string& name) {
  for (const LawNumber& n : law.numbers) {
    if (n.name == name) return n.value;
  }
  return NAN;
}

// Truth by construction. Power and blow-off on a bench: shape and number, and nothing is left. A lopsided damper, which
// the catalogue holds, is no law.
TEST(LearnLaws, namesHiddenLawsByTheirShape) {
  const std::string group = "law:component_bench:";
  const Diagnosis power = diagnosed(group + "power_law_low", 1);
  ASSERT_EQ(power.laws.size(), 1U);
  EXPECT_EQ(power.laws.front().shape, "power law");
  EXPECT_NEAR(number(power.laws.front(), "exponent"), hidden(group + "power_law_low", 1, "exponent"), 0.05);
  const PredictionError& gap = power.prediction_errors.at(model::Channel::F);
  ASSERT_TRUE(gap.catalogue);
  EXPECT_GT(*gap.catalogue, gap.after);
  EXPECT_LT(*gap.catalogue, gap.refit);
  EXPECT_EQ(power.verdict, Verdict::named);
  EXPECT_FALSE(power.unexplained);

  const Diagnosis lopsided = diagnosed(group + "asymmetric_damper", 1);
  EXPECT_TRUE(lopsided.laws.empty());
  EXPECT_FALSE(lopsided.prediction_errors.at(model::Channel::F).catalogue);
  ASSERT_EQ(lopsided.effects.size(), 1U);
  EXPECT_EQ(lopsided.effects.front().effect.entry->name, "asymmetric_damper");

  const Diagnosis valve = diagnosed(group + "blow_off", 1);
  ASSERT_EQ(valve.laws.size(), 1U);
  EXPECT_EQ(valve.laws.front().shape, "degressive");
  EXPECT_NEAR(number(valve.laws.front(), "from"), hidden(group + "blow_off", 1, "blow_off_velocity"), 0.01);
}

// Truth by construction. Where two effects of the catalogue leave nothing but noise of a power, the power is named,
// with its exponent; where the two hide indeed, they are, and no law is learned in their place.
TEST(LearnLaws, takesOneLawForTwoThatImitateIt) {
  const std::string power = "law:hil:power_law_low";
  const Diagnosis found = diagnosed(power, 100, 30.0);
  ASSERT_EQ(found.laws.size(), 1U);
  EXPECT_EQ(found.laws.front().shape, "power law");
  EXPECT_NEAR(number(found.laws.front(), "exponent"), hidden(power, 100, "exponent"), 0.05);
  EXPECT_TRUE(found.effects.empty());

  sample::Given two =
      sample::given("single:component_bench:quadratic_damping", 1, {{"viscous_damping", "", {{"damping", 300.0}}}});
  const Diagnosis both = diagnose(two.description, {{std::move(two.recording), Use::shared}});
  EXPECT_TRUE(both.laws.empty());
  EXPECT_EQ(both.effects.size(), 2U);
}

// Truth by construction. A damper whose slope falls all along is named so, with its slope at rest.
TEST(LearnLaws, NamesASlopeThatFallsAllAlong) {
  const std::string group = "law:component_bench:degressive_damper";
  const Diagnosis found = diagnosed(group, 100);
  ASSERT_EQ(found.laws.size(), 1U);
  EXPECT_EQ(found.laws.front().shape, "degressive");
  const double velocity = hidden(group, 100, "degressive_velocity");
  EXPECT_NEAR(number(found.laws.front(), "half_at") / (velocity * (std::sqrt(2.0) - 1.0)), 1.0, 0.1);
}

// Truth by construction. Friction that sets in within 10 mm/s, where the stroke's noise moves it by as much: the law
// that has dry friction as its limit is learned, with a rest beside it.
TEST(LearnLaws, RefinesDryFrictionThoughNoiseBlursIt) {
  const std::string group = "law:component_bench:smooth_friction";
  const Diagnosis found = diagnosed(group, 100);
  ASSERT_EQ(found.laws.size(), 1U);
  EXPECT_EQ(found.laws.front().shape, "smooth friction");
  EXPECT_NEAR(number(found.laws.front(), "velocity") / hidden(group, 100, "smooth_velocity"), 1.0, 0.1);
  EXPECT_TRUE(found.effects.empty());
  EXPECT_TRUE(found.unexplained);
}

// Law. The band of a curve holds the curve, its table stands in the rig that is written, and verdict.json says all of
// it.
TEST(LearnLaws, tellsTheLawAndPutsItIntoTheRig) {
  const Diagnosis found = diagnosed("law:component_bench:power_law_low", 1);
  ASSERT_EQ(found.laws.size(), 1U);
  const DescribedLaw& law = found.laws.front();
  for (std::size_t i = 0; i < law.at.size(); ++i) {
    EXPECT_LE(law.lower[i], law.force[i]);
    EXPECT_GE(law.upper[i], law.force[i]);
  }
  const auto json = to_json(found);
  ASSERT_EQ(json["laws"].size(), 1U);
  EXPECT_EQ(json["laws"][0]["place"], "suspension");
  EXPECT_EQ(json["laws"][0]["over"][0], "velocity");
  EXPECT_EQ(json["laws"][0]["memory"], false);
  EXPECT_EQ(json["laws"][0]["table"]["velocity"].size(), json["laws"][0]["table"]["force"].size());
  EXPECT_EQ(json["laws"][0]["table"]["band95"].size(), json["laws"][0]["table"]["force"].size());
}

// Law. Where nothing or an effect of the catalogue is hidden no law is learned.
TEST(LearnLaws, learnsNothingWhereTheCatalogueExplains) {
  for (const char* group : {"none:component_bench", "single:component_bench:quadratic_damping",
                            "single:component_bench:coulomb_friction", "single:component_bench:bump_stop"}) {
    EXPECT_TRUE(diagnosed(group, 1).laws.empty()) << group;
  }
}

// Truth by construction. Friction in proportion to the spring's force is a surface over deflection and velocity: its
// share is the hidden one within a twentieth, nothing but noise is left, and the rig that is written holds it.
TEST(LearnLaws, FindsFrictionThatFollowsTheLoad) {
  const std::string group = "law:component_bench:leaf_friction";
  const Diagnosis found = diagnosed(group, 1);
  ASSERT_EQ(found.laws.size(), 1U);
  const DescribedLaw& law = found.laws.front();
  EXPECT_EQ(law.shape, "follows the load");
  EXPECT_NEAR(number(law, "share_of_load") / hidden(group, 1, "leaf_friction"), 1.0, 0.05);
  EXPECT_EQ(found.verdict, Verdict::named);
  EXPECT_EQ(found.rig.rig.laws.surface_count, 1);
  const auto json = to_json(found);
  EXPECT_EQ(json["laws"][0]["over"].size(), 2U);
  EXPECT_EQ(json["laws"][0]["surface"]["force"].size(), json["laws"][0]["surface"]["deflection"].size());
}

// Truth by construction. Damping that is higher on one side of the stroke is no family's: a free surface tells what it
// adds on either side within its intervals, what is left is said, and the rig that is written holds the surface.
TEST(LearnLaws, LearnsASurfaceThatHasNoName) {
  const std::string group = "law:hil:bypass_damper";
  const Diagnosis found = diagnosed(group, 100, 20.0);
  ASSERT_EQ(found.laws.size(), 1U);
  const DescribedLaw& law = found.laws.front();
  EXPECT_EQ(law.shape, "surface");
  const nlohmann::json truth = nlohmann::json::parse(truth::truth_json(truth::draw(group, 100, {})));
  const double damping = truth["true"]["suspension.damping"], more = damping * hidden(group, 100, "bypass");
  for (const auto& [name, side] : {std::pair("damping_extended", -1.0), std::pair("damping_compressed", 1.0)}) {
    EXPECT_NEAR(number(law, name), side * more, 0.15 * more) << name;
  }
  EXPECT_EQ(found.rig.rig.laws.surface_count, 1);
  const PredictionError& gap = found.prediction_errors.at(model::Channel::F);
  ASSERT_TRUE(gap.catalogue);
  EXPECT_LT(gap.after, 1.2 * gap.noise_floor);
  EXPECT_GT(*gap.catalogue, gap.after);
}

}  // namespace
