// What a description's recorder makes of channels: each fault that a diagnosis may find goes into the description, and
// comes out of it as it was, for the same recording and for the next.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/description/rig_writer.hpp"
#include "host_sim/commands/common/recorded_as.hpp"
#include "host_sim/comparison/comparison.hpp"
#include "host_sim/identification/predict/recording_faults.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace recorder_test {
namespace {

using namespace host_sim::identification;
using model::Channel;

PlacedFault hum_fault(double hz, double cosine, double sine) {
  PlacedFault fault;
  fault.kind = FaultKind::mains_hum;
  fault.channels = {Channel::F};
  fault.values = {hz, cosine, sine};
  fault.fitted = {true, true, true};
  return fault;
}

PlacedFault drift_fault(double change, double bend) {
  PlacedFault fault;
  fault.kind = FaultKind::drift;
  fault.path = "suspension.damping";
  fault.values = {change, bend};
  fault.fitted = {true, true};
  return fault;
}

/// Every fault of a recording that a diagnosis may find on this bench.
std::vector<PlacedFault> every_fault() {
  PlacedFault digital = filter_fault({Channel::F, Channel::x_act}, 80.0, 1);
  digital.digital = true;
  return {filter_fault({Channel::F, Channel::x_act}, 50.0, 2), digital, clock_fault({Channel::F}, 4e-3, 2e-4),
          hum_fault(50.0, 30.0, -40.0), drift_fault(-0.2, 1.5)};
}

/// A recording of the sample bench with this fault.
firmware::Recording recorded_with(const std::vector<PlacedFault>& faults, double seconds, std::uint64_t seed) {
  firmware::Recording r = sample::recorded(sample::bench(), seconds, seed);
  const auto prepared = prepare_recording(sample::bench(), r, Use::fitted, false);
  Hypothesis truth = described_hypothesis(sample::bench(), {prepared});
  const host_sim::Response bare = read_channels(truth, prepared, prepared.input, truth.starts.front(), 0, {1});
  truth.faults = faults;
  const host_sim::Response with = read_channels(truth, prepared, prepared.input, truth.starts.front(), 0, {1});
  for (const Channel channel : {Channel::x_act, Channel::F}) {
    for (std::size_t k = 0; k < r.size(); ++k) r[channel][k] += with[index(channel)][k] - bare[index(channel)][k];
  }
  return r;
}

/// The description with what a diagnosis writes for these faults, through its text.
firmware::RigDescription described(const std::vector<PlacedFault>& faults) {
  firmware::RigDescription description = sample::bench();
  description.recorder = recorder_of(faults, Channel::x_cmd, {Channel::x_act, Channel::F});
  return firmware::parse_rig(firmware::format_rig(description), "found/rig.toml");
}

double power_left(const firmware::RigDescription& description, const firmware::Recording& recording) {
  auto prepared = prepare_recording(description, recording, Use::fitted, false);
  std::vector<PreparedRecording> list{std::move(prepared)};
  const Hypothesis given = described_hypothesis(description, list);
  const IdentificationProblem problem(std::move(list), given);
  const ProblemRecording& r = problem.recordings().front();
  const host_sim::Response read = read_channels(given, *r.samples, r.samples->input, given.starts.front(), 0, {1});
  std::vector<double> residual(r.fit_whitening->count());
  r.fit_whitening->whiten(r.fit_whitening->spectra(*r.samples, read), residual.data());
  double squares = 0.0;
  for (const double v : residual) squares += v * v;
  return squares / static_cast<double>(residual.size());
}

// Law. With its fault in the description a recording, and the next one of another length and noise, is left with noise:
// 1 ± 5 √(2/n), n some 2800 residuals. Without, with many times that.
TEST(Recorder, ExplainsTheNextRecording) {
  for (const PlacedFault& fault : every_fault()) {
    const firmware::RigDescription with = described({fault});
    for (const auto& [seconds, seed] : {std::pair(8.0, 5), std::pair(6.0, 77)}) {
      const firmware::Recording recording = recorded_with({fault}, seconds, static_cast<std::uint64_t>(seed));
      EXPECT_LT(power_left(with, recording), 1.15) << static_cast<int>(fault.kind) << " " << seconds;
      EXPECT_GT(power_left(sample::bench(), recording), 1.5) << static_cast<int>(fault.kind) << " " << seconds;
    }
  }
}

// `rigtwin compare` shows the same: noise is left, 10 N and 2e-5 m of the sample.
TEST(Recorder, StandsInAComparison) {
  for (const PlacedFault& fault : every_fault()) {
    const firmware::RigDescription with = described({fault});
    const firmware::Recording next = recorded_with({fault}, 6.0, 78);
    const host_sim::RecordedAs recorder = host_sim::recorded_as(with);
    for (const bool described_too : {true, false}) {
      const host_sim::ComparedRecording compared(with, next, host_sim::StartChoice::automatic,
                                                 described_too ? recorder : host_sim::RecordedAs{});
      double worst = 0.0;
      for (const auto& channel : compared.compare(compared.simulate(with.rig)).channels) {
        worst = std::max(worst, channel.error_rms / (channel.channel == Channel::F ? 10.0 : 2e-5));
      }
      if (described_too) {
        EXPECT_LT(worst, 1.1) << static_cast<int>(fault.kind);
      } else {
        EXPECT_GT(worst, 1.2) << static_cast<int>(fault.kind);
      }
    }
  }
}

// A filter that the input has, too, is undone in the channels that are not behind it; a clock of the input is early in
// the others. What a diagnosis found so comes out of the description so.
TEST(Recorder, UndoesWhatTheInputHas) {
  PlacedFault inverse = filter_fault({Channel::F}, 60.0, 2);
  inverse.inverse = true;
  const auto recorder = recorder_of({inverse}, Channel::x_act, {Channel::F, Channel::zdd_b});
  ASSERT_EQ(recorder.common_filter.size(), 1U);
  EXPECT_EQ(recorder.common_filter[0].channels, (std::vector{Channel::x_act, Channel::zdd_b}));
  const auto again = described_faults(recorder, Channel::x_act, {Channel::F, Channel::zdd_b});
  ASSERT_EQ(again.size(), 1U);
  EXPECT_TRUE(again[0].inverse);
  EXPECT_EQ(again[0].channels, std::vector{Channel::F});
  firmware::RecorderDescription late;
  late.clock.push_back({{Channel::x_act}, 4e-3, 10.0});
  const auto early = described_faults(late, Channel::x_act, {Channel::F});
  ASSERT_EQ(early.size(), 1U);
  EXPECT_EQ(early[0].channels, std::vector{Channel::F});
  EXPECT_EQ(early[0].values[0], -4e-3);
}

}  // namespace
}  // namespace recorder_test
