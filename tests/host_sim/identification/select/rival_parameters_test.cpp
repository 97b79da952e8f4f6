// Parameters of the description in the place of effects that were found.
#include "host_sim/identification/select/rival_parameters.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "tests/host_sim/identification/faulty_recording.hpp"

namespace {

using namespace host_sim::identification;

std::vector<ParameterValue> parameters_among(const std::vector<Alternative>& alternatives) {
  std::vector<ParameterValue> parameters;
  for (const Alternative& other : alternatives) {
    if (const auto* const parameter = std::get_if<ParameterValue>(&other.cause)) parameters.push_back(*parameter);
  }
  return parameters;
}

// A bench whose spring is 10.3 % too soft, with 3 % of tolerance, and whose damper is known to 10 %: a gain of F does
// the same, and costs less (suspect_parameters.hpp, 1). The recording does not tell the two apart, so neither is sure.
TEST(RivalParameters, StandBesideAGainThatASofterSpringMayBe) {
  const truth::Truth truth = truth::draw_rough("parameters_off", 2027010502);
  const Diagnosis found = sample::diagnosis_of_all(truth);
  EXPECT_EQ(found.verdict, Verdict::ambiguous);
  ASSERT_EQ(found.effects.size(), 2U) << sentence(found);
  // The delay of the machine has no parameter as a rival, and stays sure.
  EXPECT_EQ(found.effects[0].effect.entry->name, "actuator_delay");
  EXPECT_TRUE(parameters_among(found.effects[0].alternatives).empty());
  EXPECT_GT(found.effects[0].confidence, 0.99);
  const NamedEffect& gain = found.effects[1];
  EXPECT_EQ(gain.effect.entry->name, "sensor_gain");
  ASSERT_FALSE(parameters_among(gain.alternatives).empty()) << sentence(found);
  const ParameterValue spring = parameters_among(gain.alternatives)[0];  // the nearest one stands first
  EXPECT_EQ(spring.path, "suspension.stiffness");
  EXPECT_NEAR(spring.value / truth.actual.at(spring.path), 1.0, 5e-3);
  EXPECT_LT(gain.alternatives[0].odds_against, thresholds::close_odds);
  EXPECT_LE(gain.confidence, 1.0 / (1.0 + 1.0 / gain.alternatives[0].odds_against));
  EXPECT_FALSE(gain.alternatives[0].separate_by.empty());
  // It is said.
  EXPECT_NE(sentence(found).find("(or suspension.stiffness is "), std::string::npos) << sentence(found);
  EXPECT_NE(sentence(found).find("which these recordings do not tell apart"), std::string::npos) << sentence(found);
  const nlohmann::ordered_json json = to_json(found);
  EXPECT_EQ(json["effects"][1]["alternatives"][0]["name"], "suspension.stiffness");
  EXPECT_EQ(json["effects"][1]["alternatives"][0]["value"], spring.value);
}

// Viscous damping of the suspension, and its damping in the description, are one thing in other words: no rival.
TEST(RivalParameters, AreNotTheSameInOtherWords) {
  truth::Wanted wanted;
  wanted.duration = 10.0;
  const Diagnosis found = sample::diagnosis_of_all(truth::draw("single:component_bench:viscous_damping", 1, wanted));
  EXPECT_EQ(found.verdict, Verdict::named) << sentence(found);
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_TRUE(parameters_among(found.effects[0].alternatives).empty()) << sentence(found);
}

}  // namespace
