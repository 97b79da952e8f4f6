// What a rig would have recorded, and what no rig would.
#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/identification/predict/sensor_readings.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim;
using model::Channel;

// Fault. A fit may ask for what is no rig, by itself or where a parameter drifts to: it gets no numbers, and the rig
// beside it gets its own.
TEST(TrueChannels, AreNoNumbersOfNoRig) {
  const firmware::RigDescription bench = sample::bench();
  const auto recordings = sample::prepared(bench, bench);
  const identification::PreparedRecording& r = recordings.front();
  const identification::Hypothesis given = identification::described_hypothesis(bench, recordings);
  identification::Hypothesis none = given, drifting = given;
  none.rig.suspension.stiffness = std::nan("");
  drifting.faults = {{.kind = identification::FaultKind::drift,
                      .path = "suspension.damping",
                      .values = {-3.0, 0.0},
                      .fitted = {true, false}}};
  const auto f = index(Channel::F);
  for (const auto& hypothesis : {none, drifting}) {
    const Response alone = identification::true_channels(hypothesis, r, r.input, given.starts[0], 100, {1});
    ASSERT_EQ(alone[f].size(), 100U);
    EXPECT_TRUE(std::isnan(alone[f][99]));
  }
  const auto two = identification::true_channels_of_each(
      {{&none, none.starts.data(), &r.input}, {&given, given.starts.data(), &r.input}}, r, 100, {1});
  EXPECT_TRUE(std::isnan(two[0][f][99]));
  EXPECT_EQ(two[1][f], identification::true_channels(given, r, r.input, given.starts[0], 100, {1})[f]);
}

}  // namespace
