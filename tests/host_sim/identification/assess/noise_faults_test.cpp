// Noise that is not what the description says is said by its name and its number.
#include "host_sim/identification/assess/noise_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "host_sim/identification/predict/hypothesis.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

const RecordingFault* named(const std::vector<RecordingFault>& list, const std::string& name, Channel channel) {
  const auto it = std::find_if(list.begin(), list.end(), [&](const RecordingFault& fault) {
    return fault.name == name && fault.channels == std::vector<Channel>{channel};
  });
  return it == list.end() ? nullptr : &*it;
}

std::vector<RecordingFault> faults_of(const firmware::Recording& recording) {
  std::vector<PreparedRecording> list{prepare_recording(sample::bench(), recording, Use::shared, false)};
  const Hypothesis given = described_hypothesis(sample::bench(), list);
  return noise_faults(IdentificationProblem(std::move(list), given));
}

// Law. A force whose noise is three times as loud as declared, and a deflection behind a digital low-pass of first
// order, of which t/(1 + t) of the power is left, t = tan(π · 100 Hz · 1 ms). White noise is known to 1 % (asked: 5 %).
// Of noise that falls with frequency the level below the corner is read off what lies above the motion: 15 % of the
// level, 10 % of the corner.
TEST(NoiseFaults, SayLevelAndColourByChannel) {
  const firmware::Recording declared = sample::recorded(sample::bench(), 12.0);
  EXPECT_TRUE(faults_of(declared).empty());

  firmware::Recording r = declared;
  support::NormalNoise noise(8);
  for (double& f : r[Channel::F]) f += std::sqrt(8.0) * sample::force_noise * noise();
  const double t = std::tan(std::numbers::pi * 100.0 * sample::period);
  double before = r[Channel::x_act].front(), left = before;
  for (double& x : r[Channel::x_act]) {
    left = (t * (x + before) + (1.0 - t) * left) / (1.0 + t);
    before = std::exchange(x, left);
  }
  const auto faults = faults_of(r);
  const RecordingFault* const level = named(faults, "noise_level", Channel::F);
  ASSERT_NE(level, nullptr);
  EXPECT_NEAR(level->parameters.at("factor").value, 3.0, 0.15);
  const RecordingFault* const quiet = named(faults, "noise_level", Channel::x_act);
  ASSERT_NE(quiet, nullptr);
  EXPECT_NEAR(quiet->parameters.at("factor").value, std::sqrt(t / (1.0 + t)), 0.075);
  const RecordingFault* const colour = named(faults, "noise_colour", Channel::x_act);
  ASSERT_NE(colour, nullptr);
  EXPECT_NEAR(colour->parameters.at("corner_hz").value, 100.0, 10.0);
  EXPECT_EQ(named(faults, "noise_colour", Channel::F), nullptr);
}

}  // namespace
