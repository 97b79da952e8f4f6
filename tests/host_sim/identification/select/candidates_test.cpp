// Start values of candidate effects that are read off the samples of a channel.
#include "host_sim/identification/select/candidates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tests/host_sim/identification/test_signals.hpp"
#include "tests/support/reference_road.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

/// A bench of which one channel is cut off at 8 before a low-pass of 40 Hz, or not. Noise of rms 0.05 comes before the
/// limit, where a sensor makes it, or behind it.
PreparedRecording bench(Channel channel, bool cut_off, bool noise_behind = false) {
  constexpr std::size_t n = 20'000;
  PreparedRecording e;
  e.recording.sample_period = e.input.period = 1e-3;
  e.recording.time = firmware::sample_times(n, 1000.0);
  e.channels = {channel};
  e.noise[index(channel)] = 0.05;
  const auto slow = sample::sine(6.0, 0.93, n), fast = sample::sine(5.0, 2.11, n);
  support::NormalNoise noise(3);
  double filtered = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double before = 0.05 * noise(), behind = 0.05 * noise();
    double v = slow[k] + fast[k] + (noise_behind ? 0.0 : before);
    if (cut_off) v = std::clamp(v, -8.0, 8.0);
    filtered += 0.22 * (v - filtered);
    e.recording[channel].push_back(filtered + (noise_behind ? behind : 0.0));
  }
  e.recording[Channel::x_cmd] = slow;
  return e;
}

/// The start value of sensor_saturation of the channel; nullopt: the effect is no candidate.
std::optional<double> limit_of(const PreparedRecording& recording) {
  Hypothesis hypothesis;
  hypothesis.rig.kind = model::RigKind::component_bench;
  Scales scales;
  for (const Candidate& candidate : candidates({recording}, hypothesis, scales)) {
    if (candidate.entry->name == "sensor_saturation" && candidate.channel == recording.channels.front()) {
      return candidate.starts.front().values.front();
    }
  }
  return std::nullopt;
}

// Edge. A component that is described without stiffness and damping makes no force, so starts in proportion to it would
// be shares of nothing: half of what is measured is the least. Without an offset, which is no motion.
TEST(Candidates, BeginAtTheMeasuredForceWhereNoneIsDescribed) {
  PreparedRecording recording = bench(Channel::F, false);
  for (double& force : recording.recording[Channel::F]) force += 150.0;
  Hypothesis hypothesis;
  hypothesis.rig.kind = model::RigKind::component_bench;
  const std::size_t n = recording.recording.size();
  recording.input.motion.resize(n);
  host_sim::Response response;
  for (auto& channel : response) channel.assign(n, 0.0);
  const double measured = std::sqrt(0.5 * (6.0 * 6.0 + 5.0 * 5.0));
  EXPECT_NEAR(scales_of({recording}, hypothesis, {response}).motion.force / measured, 0.5, 0.05);
}

// Fault. The tops of what was cut off are round behind a low-pass, and no value comes twice: the most frequent top is
// the limit, within half of its bin (1 % of 8). A force must stand still there, since a component that yields has tops
// of its own, with noise.
TEST(Candidates, BeginALimitAtTheMostFrequentTop) {
  for (const Channel channel : {Channel::x_act, Channel::F}) {
    const std::optional<double> limit = limit_of(bench(channel, true));
    ASSERT_TRUE(limit) << model::name(channel);
    EXPECT_NEAR(*limit, 8.0, 0.04 + 0.02) << model::name(channel) << ": half a bin, and 0.4 of the noise";
    EXPECT_FALSE(limit_of(bench(channel, false))) << model::name(channel);
  }
  EXPECT_TRUE(limit_of(bench(Channel::x_act, true, true)));
  EXPECT_FALSE(limit_of(bench(Channel::F, true, true)));
}

}  // namespace
