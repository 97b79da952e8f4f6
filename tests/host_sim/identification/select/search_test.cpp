// What is found where a channel is held, and where two causes are the same to every channel. The recordings come from
// tests/truth, which shares no code with the model.
#include "host_sim/identification/select/search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "tests/host_sim/identification/faulty_recording.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using identification::Diagnosis;

/// Ten seconds of a bench with these effects, and perhaps a law that no catalogue holds.
Diagnosis of_bench(std::vector<truth::Effect> effects, std::uint64_t noise_seed,
                   std::map<std::string, double> unknown = {}) {
  truth::Truth truth = truth::draw("none:component_bench", 3);
  truth.effects = std::move(effects);
  truth.unknown_parameters = std::move(unknown);
  truth.records.resize(1);
  truth.records[0].duration = 10.0;
  truth.records[0].warm = 0.0;
  truth.records[0].noise_seed = noise_seed;
  return identification::diagnose(
      parse_rig(truth::rig_toml(truth), "rig.toml"),
      {{parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv"), identification::Use::shared}});
}

// Journey. Beside a delay that explains nearly all, a spring that stiffens a little is worth its penalty and shows in
// no band by four standard deviations: it is looked for all the same.
TEST(Search, FindsAWeakEffectBesideAStrongOne) {
  for (const std::uint64_t noise_seed : {1U, 2U}) {
    const Diagnosis found = of_bench(
        {{"sensor_delay", "F", {{"delay", 6e-3}}}, {"progressive_spring", "", {{"cubic_stiffness", 1e6}}}}, noise_seed);
    ASSERT_EQ(found.effects.size(), 2U) << identification::sentence(found);
    EXPECT_EQ(found.effects[1].effect.entry->name, "progressive_spring") << identification::sentence(found);
  }
}

// Journey. A laser sensor that measures every 5 ms beside a recorder of 1 kHz is renewed with every fifth sample,
// wherever between two of them it measures: only its values tell. Taken for another instant, by up to half a sample, it
// would leave a delay.
TEST(Search, FindsWhenAHoldInStepWithTheRecorderTakesItsValues) {
  for (const std::uint64_t noise_seed : {1U, 2U, 3U}) {
    const Diagnosis found = of_bench({{"sensor_hold", "F", {{"period", 5e-3}}}}, noise_seed);  // five samples exactly
    ASSERT_EQ(found.effects.size(), 1U) << "noise seed " << noise_seed;
    EXPECT_EQ(found.effects[0].effect.entry->name, "sensor_hold") << "noise seed " << noise_seed;
    EXPECT_NEAR(found.effects[0].effect.values[0], 5e-3, 1e-6) << "noise seed " << noise_seed;
    EXPECT_FALSE(found.unexplained) << "noise seed " << noise_seed;
  }
}

// Journey. A late clock of the command is the same to every channel as a delay of the drive, and a filter of all that
// moves the same as its lag: the drive is named.
TEST(Search, NamesTheDriveRatherThanTheRecorder) {
  const std::vector<std::vector<truth::Effect>> rigs{
      {{"actuator_lag", "", {{"time_constant", 3.4e-3}}},
       {"actuator_resonance", "", {{"frequency", 35.0}, {"damping_ratio", 0.43}}},
       {"sensor_offset", "F", {{"offset", -78.0}}},
       {"viscous_damping", "", {{"damping", 360.0}}}},
      {{"actuator_delay", "", {{"delay", 4.1e-3}}},
       {"actuator_resonance", "", {{"frequency", 33.7}, {"damping_ratio", 0.49}}},
       {"actuator_rate_limit", "", {{"velocity", 0.33}}},
       {"progressive_spring", "", {{"cubic_stiffness", 2e8}}},
       {"relaxation", "", {{"stiffness", 1.4e4}, {"time_constant", 0.05}}}}};
  for (const std::vector<truth::Effect>& rig : rigs) {
    const Diagnosis found = of_bench(rig, 1);
    const std::string said = identification::sentence(found);
    EXPECT_TRUE(found.recording_faults.empty()) << said;
    ASSERT_EQ(found.effects.size(), rig.size()) << said;
    for (const truth::Effect& hidden : rig) {
      EXPECT_TRUE(std::any_of(found.effects.begin(), found.effects.end(),
                              [&](const auto& effect) { return effect.effect.entry->name == hidden.name; }))
          << hidden.name << ": " << said;
    }
  }
}

// Journey. A machine that lags and is late moves a component whose friction no catalogue holds. Far above noise an
// overdamped resonance is better than a lag or a delay alone, and what the friction leaves hides the rest of it: both
// are found in its place. Tolerance: their intervals, which the friction widens.
TEST(Search, FindsTwoEffectsThatLookLikeOne) {
  const Diagnosis found =
      of_bench({{"actuator_lag", "", {{"time_constant", 22e-3}}}, {"actuator_delay", "", {{"delay", 4.5e-3}}}}, 1,
               {{"bristle", 300.0}, {"bristle_excess", 120.0}, {"bristle_stiffness", 2e5}, {"bristle_velocity", 0.02}});
  const std::string said = identification::sentence(found);
  for (const auto& [name, value] : {std::pair("actuator_lag", 22e-3), std::pair("actuator_delay", 4.5e-3)}) {
    const auto it = std::find_if(found.effects.begin(), found.effects.end(),
                                 [n = name](const auto& effect) { return effect.effect.entry->name == n; });
    ASSERT_NE(it, found.effects.end()) << name << ": " << said;
    EXPECT_LT(it->parameters[0].lower, value) << name << ": " << said;
    EXPECT_GT(it->parameters[0].upper, value) << name << ": " << said;
  }
}

// Journey. A component behind a soft mount relaxes, too. A lag and a gain of F are nearly what the mount does, and the
// mount in the place of either is worse.
TEST(Search, FindsOneEffectThatLooksLikeTwo) {
  truth::Truth truth = truth::draw_rough("gaps", 2026120601);
  truth.rough.lost = 0.0;  // the rows are there, only this is asked
  ASSERT_EQ(truth.effects.size(), 2U);
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = identification::sentence(found);
  ASSERT_EQ(found.effects.size(), 2U) << said;
  for (const truth::Effect& hidden : truth.effects) {
    const auto named = std::find_if(found.effects.begin(), found.effects.end(),
                                    [&](const auto& e) { return e.effect.entry->name == hidden.name; });
    ASSERT_NE(named, found.effects.end()) << said;
    // 1 % of the stiffness: its 95 % interval is 0.6 % wide.
    EXPECT_NEAR(named->effect.values[0] / hidden.parameters.at("stiffness"), 1.0, 0.01) << said;
  }
}

// Journey. Backlash in a car has many minima: fitted from its best start the gap stayed 0.3 % beside the true one, and
// two laws explained what that left. From 5 % more the fit finds it.
TEST(Search, FindsTheGapAmongManyMinima) {
  truth::Truth truth = truth::draw("single:quarter_car:backlash", 2026120500);
  truth.records.erase(truth.records.begin());
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = identification::sentence(found);
  EXPECT_TRUE(found.laws.empty()) << said;
  EXPECT_FALSE(found.unexplained) << said;
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "backlash") << said;
}

// Journey. A lag of 5.6 ms beside friction and an offset was first found as a resonance of 1.1 kHz with the largest
// damping of its card, which is the same motion; the lag, fitted from the rig without it, stuck in another minimum.
TEST(Search, CallsAResonanceAtItsLimitALag) {
  const truth::Truth truth = truth::draw_rough("many", 2026121400);
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = identification::sentence(found);
  ASSERT_EQ(found.effects.size(), truth.effects.size()) << said;
  for (const truth::Effect& hidden : truth.effects) {
    EXPECT_TRUE(std::any_of(found.effects.begin(), found.effects.end(),
                            [&](const auto& e) { return e.effect.entry->name == hidden.name; }))
        << hidden.name << ": " << said;
  }
}

// Stribeck friction on a road, found with its values, left 1.8 times the noise of zdd_w above 60 Hz, where noise moves
// the instants of sticking. That was a rest, so a law beside Coulomb friction was learned in its place.
TEST(Search, FrictionThatFallsIsNoOtherLaw) {
  const auto found = sample::diagnosis_of_all(truth::draw_rough("neighbour_laws", 2026122300));
  const std::string said = host_sim::identification::sentence(found);
  ASSERT_FALSE(found.effects.empty()) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "stribeck_friction") << said;
  EXPECT_GT(found.effects[0].confidence, 0.9) << said;
  for (std::size_t i = 1; i < found.effects.size(); ++i) EXPECT_LT(found.effects[i].confidence, 0.5) << said;
  EXPECT_TRUE(found.laws.empty()) << said;
  EXPECT_FALSE(found.unexplained) << said;
  EXPECT_NEAR(found.effects[0].parameters[2].value, 0.0335, 0.001);  // [m/s] v_s; five half widths
}

// Friction that sets in over 14 mm/s, beside a lag: Coulomb friction leaves a quarter of the noise's power more. On a
// machine that follows x_cmd no noise of an input blurs the instants of sticking, so that is a rest.
TEST(Search, FrictionThatSetsInIsALaw) {
  const auto found = sample::diagnosis_of_all(truth::draw_rough("neighbour_laws", 2026122401));
  const std::string said = host_sim::identification::sentence(found);
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "sensor_lag") << said;
  ASSERT_EQ(found.laws.size(), 1U) << said;
  EXPECT_EQ(found.laws[0].shape, "smooth friction") << said;
}

}  // namespace
