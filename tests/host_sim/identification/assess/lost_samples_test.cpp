// What a recorder did to single samples is said, and changes nothing else.
#include "host_sim/identification/assess/lost_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

const RecordingFault* find_fault(const std::vector<RecordingFault>& list, const std::string& name) {
  const auto it = std::find_if(list.begin(), list.end(), [&](const RecordingFault& f) { return f.name == name; });
  return it == list.end() ? nullptr : &*it;
}

// Journey. A bench with friction, seven samples of F far off, one of them held out, and x_act rounded to 4 times its
// noise: three answers, the friction as without them.
TEST(LostSamples, AreSaidBesideAnEffect) {
  const auto description = sample::bench();
  firmware::Recording r = sample::recorded(sample::with_effect(description, "coulomb_friction", {40.0}), 12.0);
  for (const std::size_t k : {400UL, 1'111UL, 1'112UL, 2'500UL, 5'000UL, 7'000UL, 11'000UL}) {
    r[Channel::F][k] += k % 2 == 0 ? 600.0 : -900.0;
  }
  const double step = 4.0 * sample::deflection_noise;
  for (double& v : r[Channel::x_act]) v = step * std::round(v / step);
  const Diagnosis found = diagnose(description, {{r, Use::shared}});
  EXPECT_EQ(found.verdict, Verdict::named);
  EXPECT_FALSE(found.unexplained) << found.residual;
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].effect.entry->name, "coulomb_friction");
  EXPECT_NEAR(found.effects[0].parameters[0].value, 40.0, 0.8);
  const RecordingFault* const outliers = find_fault(found.recording_faults, "outliers");
  ASSERT_NE(outliers, nullptr);
  EXPECT_EQ(outliers->channels, std::vector<Channel>{Channel::F});
  EXPECT_EQ(outliers->parameters.at("count").value, 7.0);
  const RecordingFault* const rounding = find_fault(found.recording_faults, "quantisation");
  ASSERT_NE(rounding, nullptr);
  EXPECT_EQ(rounding->channels, std::vector<Channel>{Channel::x_act});
  EXPECT_NEAR(rounding->parameters.at("step").value, step, 1e-3 * step);
  EXPECT_EQ(find_fault(found.recording_faults, "noise_level"), nullptr) << "the rounding is said, not its noise again";
}

// Law. What the model reads where it was recorded is motion: such samples are left out, and not counted.
TEST(LostSamples, AreNotWhatTheModelExplains) {
  auto recordings = sample::prepared(sample::bench(), sample::bench());
  const auto f = index(Channel::F);
  PreparedRecording& r = recordings.front();
  const Hypothesis given = described_hypothesis(sample::bench(), recordings);
  const host_sim::Response read = read_channels(given, r, r.input, given.starts[0], 0, {r.substeps});
  r.outliers[f] = {3, {100, 200, 300}, {read[f][100] + 5.0, read[f][200] + 900.0, read[f][300] - 900.0}};
  r.recording[Channel::F][100] = read[f][100] + 500.0;  // mended from neighbours that did not touch the stop
  const IdentificationProblem problem(std::move(recordings));
  const auto faults = lost_samples(problem, given);
  const RecordingFault* const outliers = find_fault(faults, "outliers");
  ASSERT_NE(outliers, nullptr);
  EXPECT_EQ(outliers->parameters.at("count").value, 2.0);
  EXPECT_TRUE(outliers->is_cause);
}

// Point. Rows that a file lacks are one fault with their number, each gap one with its ends, and neither is a cause.
TEST(LostSamples, SayLostRowsAndGaps) {
  auto recordings = sample::prepared(sample::bench(), sample::bench());
  recordings.front().recording.lost_rows = 42;
  recordings.front().recording.gaps = {{1.0, 1.03}, {5.5, 5.54}};
  const Hypothesis given = described_hypothesis(sample::bench(), recordings);
  const auto faults = lost_samples(IdentificationProblem(std::move(recordings)), given);
  const RecordingFault* const rows = find_fault(faults, "lost_rows");
  ASSERT_NE(rows, nullptr);
  EXPECT_EQ(rows->parameters.at("count").value, 42.0);
  EXPECT_FALSE(rows->is_cause);
  EXPECT_EQ(std::count_if(faults.begin(), faults.end(), [](const RecordingFault& f) { return f.name == "gap"; }), 2);
  const RecordingFault* const gap = find_fault(faults, "gap");
  EXPECT_EQ(gap->parameters.at("from_s").value, 1.0);
  EXPECT_EQ(gap->parameters.at("to_s").value, 1.03);
}

}  // namespace
