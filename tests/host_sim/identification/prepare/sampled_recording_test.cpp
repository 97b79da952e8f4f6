// Recordings of any rate come to the rate of their simulation.
#include "host_sim/identification/prepare/sampled_recording.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/identification/diagnosis.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"
#include "tests/support/rig_descriptions.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

/// A rig of tests/truth recorded at a rate that is not its loop's.
sample::Given recorded_at(double rate, const std::string& group, double duration) {
  truth::Wanted wanted;
  wanted.duration = duration;
  truth::Truth truth = truth::draw(group, 1, wanted);
  truth.records.resize(1);
  sample::Given given{firmware::parse_rig(truth::rig_toml(truth), "rig.toml"), {}};
  truth.sample_rate = rate;
  given.recording = firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth).front()), "rec.csv");
  return given;
}

// Point. Slow recordings get samples between, of which the recorded ones are compared; of fast ones every tenth stays.
TEST(SampledRecording, ComesToAKilohertz) {
  sample::Given slow = recorded_at(200.0, "none:quarter_car", 6.0);
  slow.description.range[index(Channel::F_w)] = {-100.0, 100.0};
  const std::vector<double> force = slow.recording[Channel::F_w];
  const SampledRecording finer = sampled(slow.description, slow.recording);
  EXPECT_EQ(finer.step, 5U);
  EXPECT_NEAR(finer.recording.sample_period, 1e-3, 1e-12);
  ASSERT_EQ(finer.recording.size(), 5U * (force.size() - 1) + 1);
  const auto& clipped = finer.clipped[index(Channel::F_w)];
  ASSERT_EQ(clipped.size(), finer.recording.size());
  for (std::size_t k = 0; k < force.size(); ++k) {
    ASSERT_EQ(finer.recording[Channel::F_w][5 * k], force[k]);
    ASSERT_EQ(clipped[5 * k], std::abs(force[k]) >= 100.0);
  }
  EXPECT_NEAR(finer.noise_at_every_sample(Channel::F_w), std::sqrt(5.0) * finer.noise[index(Channel::F_w)], 1e-9);

  const sample::Given fast = recorded_at(10e3, "none:quarter_car", 3.0);
  const SampledRecording fewer = sampled(fast.description, fast.recording);
  EXPECT_EQ(fewer.step, 1U);
  ASSERT_EQ(fewer.recording.size(), 3000U);
  EXPECT_EQ(fewer.recording[Channel::zdd_b][7], fast.recording[Channel::zdd_b][70]);

  EXPECT_EQ(sampled(slow.description, recorded_at(500.0, "none:quarter_car", 3.0).recording).step, 2U);
}

Diagnosis diagnosis_at(double rate, const std::string& group, double duration = 14.0) {
  const sample::Given given = recorded_at(rate, group, duration);
  return diagnose(given.description, {{given.recording, Use::shared}});
}

// Journey. A rig without any effect stays without one at rates from 100 Hz to 10 kHz: with the input straight or cubic
// between slow samples a relaxation would explain what the interpolation gets wrong.
TEST(DiagnosisAtAnyRate, FindsNothingWhereNothingIs) {
  for (const double rate : {100.0, 200.0, 500.0, 2000.0, 5000.0, 10e3}) {
    const Diagnosis diagnosis = diagnosis_at(rate, "none:quarter_car");
    EXPECT_EQ(diagnosis.verdict, Verdict::no_discrepancy) << rate << " Hz: " << diagnosis.residual;
    EXPECT_TRUE(diagnosis.effects.empty()) << rate << " Hz";
  }
}

// Journey. What hides is named at each of them, with its size.
TEST(DiagnosisAtAnyRate, NamesWhatHides) {
  for (const double rate : {100.0, 250.0, 5000.0}) {
    const Diagnosis lag = diagnosis_at(rate, "single:quarter_car:sensor_lag:zdd_b");
    ASSERT_EQ(lag.effects.size(), 1U) << rate << " Hz";
    EXPECT_EQ(lag.effects.front().effect.entry->name, "sensor_lag") << rate << " Hz";
  }
  const Diagnosis backlash = diagnosis_at(200.0, "single:component_bench:backlash");
  ASSERT_EQ(backlash.effects.size(), 1U);
  EXPECT_EQ(backlash.effects.front().effect.entry->name, "backlash");
}

// Journey. The limit of a sensor is read off the samples that were recorded: between them an interpolation overshoots.
TEST(DiagnosisAtAnyRate, ReadsALimitOffTheRecordedSamples) {
  for (const double rate : {250.0, 500.0}) {
    const Diagnosis cut = diagnosis_at(rate, "single:quarter_car:sensor_saturation:dz_b");
    ASSERT_EQ(cut.effects.size(), 1U) << rate << " Hz";
    EXPECT_EQ(cut.effects.front().effect.entry->name, "sensor_saturation") << rate << " Hz";
  }
}

// Point. 3 s are enough for two periods of a body mode; 2 s are not.
TEST(DiagnosisAtAnyRate, TakesShortRecordings) {
  EXPECT_EQ(diagnosis_at(1000.0, "none:quarter_car", 3.5).verdict, Verdict::no_discrepancy);
  EXPECT_THROW((void)diagnosis_at(1000.0, "none:quarter_car", 2.0), firmware::InputError);
}

// Point. A bench at 10 Hz takes 17 steps a sample, and with corners four times as many, as at any rate.
TEST(SampledRecording, TakesLongerStepsWhereABenchIsSlow) {
  const auto description = firmware::parse_rig(support::bench_text, "rig.toml");
  firmware::Recording recording;
  recording.source = "REC.csv";
  recording.sample_period = 0.1;
  recording.time = firmware::sample_times(200, 10.0);
  for (int k = 0; k < 200; ++k) {
    recording[Channel::x_cmd].push_back(1e-3 * std::sin(0.2 * k));
    recording[Channel::F].push_back(30.0 * std::sin(0.2 * k));
  }
  const SampledRecording slow = sampled(description, recording);
  EXPECT_EQ(slow.step, 17U);
  EXPECT_DOUBLE_EQ(slow.slower, 6.0);
  EXPECT_EQ(prepare_recording(description, slow, Use::shared, false).substeps, 4);
}

}  // namespace
