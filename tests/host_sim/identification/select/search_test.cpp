// What is found where a channel is held. The recordings come from tests/truth, which shares no code with the model.
#include "host_sim/identification/select/search.hpp"

#include <gtest/gtest.h>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using identification::Diagnosis;

/// Ten seconds of a bench whose force is held for 5 ms, five samples exactly.
Diagnosis held_in_step(std::uint64_t noise_seed) {
  truth::Truth truth = truth::draw("none:component_bench", 3);
  truth.effects = {{"sensor_hold", "F", {{"period", 5e-3}}}};
  truth.records.resize(1);
  truth.records[0].duration = 10.0;
  truth.records[0].warm = 0.0;
  truth.records[0].noise_seed = noise_seed;
  return identification::diagnose(
      parse_rig(truth::rig_toml(truth), "rig.toml"),
      {{parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv"), identification::Use::shared}});
}

// Journey. A laser sensor that measures every 5 ms beside a recorder of 1 kHz is renewed with every fifth sample,
// wherever between two of them it measures: only its values tell. Taken for another instant, by up to half a sample, it
// would leave a delay.
TEST(Search, FindsWhenAHoldInStepWithTheRecorderTakesItsValues) {
  for (const std::uint64_t noise_seed : {1U, 2U, 3U}) {
    const Diagnosis found = held_in_step(noise_seed);
    ASSERT_EQ(found.effects.size(), 1U) << "noise seed " << noise_seed;
    EXPECT_EQ(found.effects[0].effect.entry->name, "sensor_hold") << "noise seed " << noise_seed;
    EXPECT_NEAR(found.effects[0].effect.values[0], 5e-3, 1e-6) << "noise seed " << noise_seed;
    EXPECT_FALSE(found.unexplained) << "noise seed " << noise_seed;
  }
}

}  // namespace
