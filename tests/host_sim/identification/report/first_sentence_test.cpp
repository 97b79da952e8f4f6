// What does the first sentence say? Of runs of the description itself, and of answers that are less than sure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/simulation/road_choice.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace first_sentence_test {
namespace {

using namespace host_sim;
using namespace host_sim::identification;
using model::Channel;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* agrees =
    "Rig and model agree: what is left over is noise, with every parameter within its tolerance.";

firmware::RigDescription car(const std::string& noise) {
  return firmware::parse_rig(
      "kind = \"quarter_car\"\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\nstiffness = "
      "200e3\ndamping = 100.0\n[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n" +
          noise,
      "car.toml");
}

constexpr const char* five_of_seven = "[noise]\nz_r = 2e-5\nzdd_w = 0.05\nzdd_b = 0.05\ndz_b = 5e-5\nF_w = 10.0\n";

/// The recording that rigtwin simulate makes of it.
firmware::Recording run(const firmware::RigDescription& rig, std::uint64_t seed, double duration = 8.0) {
  const firmware::RoadChoice road{"iso8608:B", 27.78, seed, std::nullopt, std::nullopt};
  RunOptions options;
  options.seed = seed;
  options.noise = firmware::SimulatedRig::Noise::as_described;
  auto motion = firmware::motion_over(road, rig, firmware::samples_of(duration, rig.sample_rate), read_recording);
  Run made = run_closed_loop(rig, firmware::excitation(rig.rig, std::move(motion), rig.sample_rate), options);
  made.recording.source = "run.csv";
  return std::move(made.recording);
}

Diagnosis diagnosed(const firmware::RigDescription& rig, firmware::Recording recording) {
  return diagnose(rig, {{std::move(recording), Use::shared}});
}

// A description that gives the noise of five of seven channels: the other two are simulated without. No channel is more
// exact than the model, so the description explains its own run.
TEST(FirstSentence, AgreesWithTheDescriptionsOwnRun) {
  const firmware::RigDescription rig = car(five_of_seven);
  for (const std::uint64_t seed : {1U, 2U}) {
    const Diagnosis found = diagnosed(rig, run(rig, seed));
    EXPECT_EQ(sentence(found), agrees) << "seed " << seed;
  }
}

// Channels without any noise have a spectrum that falls off with the road: that is no filter of the recorder.
TEST(FirstSentence, SeesNoFilterInExactChannels) {
  const firmware::RigDescription rig = car("");
  const Diagnosis found = diagnosed(rig, run(rig, 1));
  EXPECT_EQ(sentence(found), agrees);
  EXPECT_TRUE(found.recording_faults.empty()) << words(found.recording_faults.front());
}

// A load cell that was not tared: said once, under recording, and the rest is about motion.
TEST(FirstSentence, TakesTheStaticWheelLoadOff) {
  const firmware::RigDescription rig =
      car("[noise]\nz_r = 2e-5\nzdd_r = 0.05\nzdd_w = 0.05\nzdd_b = 0.05\ndz_w = 5e-5\ndz_b = 5e-5\nF_w = 10.0\n");
  firmware::Recording recording = run(rig, 3);
  for (double& v : recording[Channel::F_w]) v += 3500.0;
  const Diagnosis found = diagnosed(rig, std::move(recording));
  EXPECT_EQ(sentence(found), agrees);
  ASSERT_EQ(found.recording_faults.size(), 1U);
  EXPECT_EQ(found.recording_faults[0].name, "static_value");
  EXPECT_NEAR(found.recording_faults[0].parameters.at("value").value, 3500.0, 30.0);
  EXPECT_THAT(words(found.recording_faults[0]), HasSubstr("static wheel load"));
  // About motion: the noise of 10 N in some 500 N of dynamic load.
  EXPECT_NEAR(found.prediction_errors.at(Channel::F_w).before, 0.021, 0.01);
  EXPECT_EQ(to_json(found)["recording"][0]["name"], "static_value");
}

NamedEffect friction(double confidence) {
  return {{firmware::find_effect("coulomb_friction"), std::nullopt, {9.0}}, {{9.0, 8.0, 10.0}}, confidence, {}, {}};
}

Diagnosis with(std::vector<NamedEffect> effects) {
  Diagnosis found;
  found.verdict = identification::Verdict::named;
  found.effects = std::move(effects);
  found.rig = car("");
  return found;
}

// Headlines are as firm as their confidence.
TEST(FirstSentence, IsAsFirmAsItsConfidence) {
  EXPECT_THAT(sentence(with({friction(0.99)})), StartsWith("The model lacks coulomb_friction"));
  EXPECT_THAT(sentence(with({friction(0.82)})), StartsWith("The model probably lacks coulomb_friction"));
  EXPECT_THAT(sentence(with({friction(0.279)})), StartsWith("The model may lack coulomb_friction"));
  const NamedEffect gain{
      {firmware::find_effect("sensor_gain"), Channel::F_w, {1.0021}}, {{1.0021, 1.001, 1.003}}, 0.82, {}, {}};
  EXPECT_THAT(sentence(with({friction(0.99), gain})),
              StartsWith("The model lacks coulomb_friction (9 N); it probably lacks sensor_gain of F_w (1.002)"));
  // The balance that the channel takes part in holds.
  Diagnosis found = with({gain});
  ParityResidual balance;
  balance.relation = "wheel load";
  balance.locations.push_back({"sensor F_w", {}});
  found.relations.push_back(balance);
  EXPECT_THAT(sentence(found), StartsWith("The model may lack sensor_gain of F_w"));
  RecordingFault fault{"clock_offset", {Channel::F_w}, {}, 7.83e-127, {}, true, {}, {}};
  EXPECT_THAT(words(fault), HasSubstr("confidence below 0.001"));
}

// One language: what adds to a parameter of the description is said in its words, too.
TEST(FirstSentence, SaysWhatAnEffectMakesOfAParameter) {
  NamedEffect damper{
      {firmware::find_effect("viscous_damping"), std::nullopt, {300.0}}, {{300.0, 299.0, 301.0}}, 0.99, {}, {}};
  Diagnosis found = with({damper});
  found.rig.rig.suspension.damping = 1500.0;
  EXPECT_THAT(sentence(found), HasSubstr("viscous_damping (300 N s/m: suspension.damping is 1800, not 1500)"));
  found.rig.tolerance["suspension.damping"] = 0.05;
  EXPECT_THAT(sentence(found), HasSubstr("suspension.damping is 1800, beyond its tolerance)"));
  found.rig.rig.suspension.damping = 0.0;  // the description has no damper: the effect is one
  EXPECT_THAT(sentence(found), HasSubstr("viscous_damping (300 N s/m)"));
}

// One law at one place: an effect and a law that both are a force of the suspension are said as one.
TEST(FirstSentence, JoinsAnEffectAndALawOfOnePlace) {
  Diagnosis found = with({friction(0.95)});
  DescribedLaw law;
  law.law.place = CurvePlace::suspension;
  law.law.over = CurveOver::velocity;
  law.shape = "friction";
  law.words = "friction of 36 N";
  law.numbers = {{"force", 36.0, 35.0, 37.0}};
  law.confidence = 0.95;
  found.laws.push_back(law);
  EXPECT_THAT(sentence(found), HasSubstr("at the same place one law of 45 N in all"));
  // Finite or nothing: what a law leaves open has no number, and the rest of the verdict stands.
  found.laws[0].numbers.push_back({"velocity", INFINITY, 0.0, INFINITY});
  const auto json = to_json(found);
  EXPECT_TRUE(json["laws"][0]["parameters"].contains("force"));
  EXPECT_FALSE(json["laws"][0]["parameters"].contains("velocity"));
}

}  // namespace
}  // namespace first_sentence_test
