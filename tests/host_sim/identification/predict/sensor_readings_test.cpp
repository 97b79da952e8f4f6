// Readings of sensors, and holds that are read off a recording.
#include "host_sim/identification/predict/sensor_readings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/host_sim/identification/test_signals.hpp"

namespace sensor_readings_test {
namespace {

using namespace firmware;
using namespace host_sim;
using model::Channel;
using sample::sine;

constexpr double period = 1e-3;

/// A recording whose F is renewed every `samples` (not whole), begun in the middle of a turn.
identification::PreparedRecording held_recording(double samples) {
  constexpr std::size_t n = 6000;
  identification::PreparedRecording e;
  e.recording.sample_period = e.input.period = period;
  e.recording.time = sample_times(n, 1.0 / period);
  e.channels = {Channel::F};
  double last = 7.0, due = 0.6 * samples;
  for (std::size_t k = 0; k < n; ++k) {
    if (static_cast<double>(k) >= due) {
      last = static_cast<double>(k);
      due += samples;
    }
    e.recording[Channel::F].push_back(last);
  }
  e.renewals[index(Channel::F)] = identification::renewals_of(e.recording[Channel::F]);
  return e;
}

// The phase of a hold is read off the recording: readings are renewed exactly where it was.
TEST(Readings, AreRenewedWhereTheRecordingIs) {
  const identification::PreparedRecording e = held_recording(4.3);
  identification::Hypothesis hypothesis;
  hypothesis.rig.kind = model::RigKind::component_bench;
  hypothesis.rig.effects.add(Channel::F, model::SensorHold<double>{0.0043});
  ASSERT_EQ(e.size(), 6000U);
  std::vector<double> truth;
  for (std::size_t k = 0; k < e.size(); ++k) truth.push_back(static_cast<double>(k));
  const auto read = identification::sensor_readings(hypothesis, e, Channel::F, truth);
  for (std::size_t k = 3; k < e.size(); ++k) ASSERT_EQ(read[k], e.recording[Channel::F][k]) << k;  // 3: the first turn
  // By a clock of its own it takes its value before it shows: at 2.58 + 4.3 n, which the turns leave little doubt
  // about.
  hypothesis.clocks[index(Channel::F)].own = true;
  const auto own = identification::sensor_readings(hypothesis, e, Channel::F, truth);
  for (std::size_t k = 3; k < e.size(); ++k) {
    const double taken = 2.58 + 4.3 * std::floor((static_cast<double>(k) - 2.58) / 4.3 + 1e-9);
    ASSERT_NEAR(own[k], taken, 0.11) << k;  // turns of 4.3 come at ten places between samples
  }
}

// A channel is cut off as it is on the rig, not as the filtered input would make it: the inverse of the input's filter
// raises the reading above the limit only if it comes behind it.
TEST(Readings, AreCutOffBehindTheFilterOfTheInput) {
  const identification::PreparedRecording e = held_recording(4.3);
  identification::Hypothesis hypothesis;
  hypothesis.rig.kind = model::RigKind::component_bench;
  hypothesis.rig.effects.add(Channel::F, model::SensorSaturation<double>{0.8});
  identification::PlacedFault filter;
  filter.kind = identification::FaultKind::common_filter;
  filter.channels = {Channel::F};
  filter.values = {20.0};
  filter.fitted = {true};
  filter.inverse = true;
  hypothesis.faults = {filter};
  const std::vector<double> truth = sine(0.6, 30.0, e.size());  // on the rig: 0.6 |1 + 1.5 i| = 1.08
  const auto read = identification::sensor_readings(hypothesis, e, Channel::F, truth);
  EXPECT_EQ(*std::max_element(read.begin(), read.end()), 0.8);
  EXPECT_EQ(*std::min_element(read.begin(), read.end()), -0.8);
}

// Its period too: turns at ten places between samples, over some 1395 of them, leave it less than 2 · 0.1/1395 samples.
TEST(HoldPeriod, IsReadOffTheRenewals) {
  const std::vector<identification::PreparedRecording> recordings{held_recording(4.3)};
  const auto held = identification::hold_period(recordings, Channel::F);
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->value, 4.3e-3, held->half_width);
  EXPECT_LT(held->half_width, 0.2 / 1395.0 * period);
  EXPECT_FALSE(identification::hold_period(recordings, Channel::x_act));
  // What a limit cuts off repeats itself, too, most of the time even; but it is new with every sample in between.
  auto limited = sine(1.0, 3.0, 6000);
  for (double& v : limited) v = std::clamp(v, -0.4, 0.4);
  EXPECT_FALSE(identification::renewals_of(limited));
  // Turns of 1 and 2, or of 2 and 3 samples, of which none is the period.
  for (const double samples : {1.7, 2.5}) {
    const identification::PreparedRecording fast = held_recording(samples);
    ASSERT_TRUE(fast.renewals[index(Channel::F)]) << samples;
    EXPECT_TRUE(fast.renewals[index(Channel::F)]->regular) << samples;
    EXPECT_NEAR(fast.renewals[index(Channel::F)]->period, samples, 1e-3) << samples;
  }
}

}  // namespace
}  // namespace sensor_readings_test
