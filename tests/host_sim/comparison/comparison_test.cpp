// What a recording and the simulation of its input have to do with each other, in numbers.
#include "host_sim/comparison/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::parse_rig;
using firmware::Recording;
using firmware::RigDescription;
using host_sim::ChannelComparison;
using host_sim::ComparedRecording;
using host_sim::RecordingComparison;
using host_sim::StartChoice;
using model::Channel;
using model::index;

constexpr std::string_view spring_text =
    "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 1000.0\ndamping = 0.0\n";

/// Deflections + + − − … of 10 mm against 1000 N/m, and a measured force that is 2 N too high, too low, …: 16 samples.
Recording hand_made() {
  Recording recording;
  recording.source = "REC.csv";
  recording.sample_period = 1e-3;
  recording.time = firmware::sample_times(16, 1000.0);
  for (int k = 0; k < 16; ++k) {
    const double x = k % 4 < 2 ? 0.01 : -0.01;
    recording[Channel::x_act].push_back(x);
    recording[Channel::F].push_back(1000.0 * x + (k % 2 == 0 ? -2.0 : 2.0));
  }
  return recording;
}

RecordingComparison compare(const RigDescription& rig, Recording recording,
                            StartChoice start = StartChoice::automatic) {
  const ComparedRecording compared(rig, std::move(recording), start);
  return compared.compare(compared.simulate(rig.rig));
}

const ChannelComparison& of(const RecordingComparison& comparison, Channel channel) {
  for (const ChannelComparison& c : comparison.channels) {
    if (c.channel == channel) return c;
  }
  throw std::out_of_range(std::string(model::name(channel)));
}

Recording simulated(const RigDescription& rig, std::size_t samples, bool noise, double bandwidth = 30.0) {
  firmware::IsoRoad road;
  road.bandwidth = bandwidth;
  host_sim::RunOptions options;
  if (!noise) options.noise = firmware::SimulatedRig::Noise::none;
  const auto motion =
      firmware::excitation(rig.rig, firmware::drive_over(road, rig.sample_rate, samples), rig.sample_rate);
  return host_sim::run_closed_loop(rig, motion, options).recording;
}

// Law. A recording of every fifth sample is simulated as well as the whole: between its samples the road is what its
// spectrum makes of them. A cubic between them would leave percents.
TEST(Comparison, SimulatesSlowRecordingsAtTheModelsStep) {
  const auto rig = support::rig("paper_rig_fdva");
  const Recording whole = simulated(rig, 12000, false);
  Recording slow;
  slow.source = "REC.csv";
  slow.sample_period = 5.0 * whole.sample_period;
  for (std::size_t k = 0; k < whole.size(); k += 5) {
    slow.time.push_back(whole.time[k]);
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      if (!whole.channels[c].empty()) slow.channels[c].push_back(whole.channels[c][k]);
    }
  }
  const RecordingComparison result = compare(rig, slow);
  for (const Channel channel : {Channel::zdd_w, Channel::zdd_b, Channel::dz_b, Channel::F_w}) {
    EXPECT_LT(of(result, channel).nrmse, 1e-3) << model::name(channel);
  }
}

// Point. Errors ± 2 N. Data 8, 12, −8, −12 N: mean 0, rms √((64 + 144)/2) = √104 N. nrmse = 2/√104 = 0.19612.
TEST(Comparison, NormalisesErrorsAsTheContractSays) {
  const auto rig = parse_rig(spring_text, "RIG.toml");
  const RecordingComparison result = compare(rig, hand_made());
  EXPECT_EQ(result.source, "REC.csv");
  EXPECT_EQ(result.input, Channel::x_act);
  EXPECT_DOUBLE_EQ(result.duration, 0.016);
  ASSERT_EQ(result.channels.size(), 1U);
  const ChannelComparison& F = result.channels[0];
  EXPECT_NEAR(F.error_rms, 2.0, 1e-12);
  EXPECT_NEAR(F.data_rms, std::sqrt(104.0), 1e-12);
  EXPECT_NEAR(F.nrmse, 2.0 / std::sqrt(104.0), 1e-12);
  EXPECT_EQ(F.clipped, 0U);
}

// The contract's nrmse: about the mean of the data, but not of the error. A measured force that is 3 N too high all the
// time is an error of 3 N, and the data's rms is as before.
TEST(Comparison, CountsAConstantErrorButNotAConstantSignal) {
  const auto rig = parse_rig(spring_text, "RIG.toml");
  Recording recording = hand_made();
  for (double& F : recording[Channel::F]) F += 3.0;
  const ChannelComparison F = of(compare(rig, recording), Channel::F);
  EXPECT_NEAR(F.error_rms, std::sqrt(4.0 + 9.0), 1e-12);
  EXPECT_NEAR(F.data_rms, std::sqrt(104.0), 1e-12);
}

// Samples at or beyond the range are counted and left out: by hand, without the four of − 12 N and the four of 12 N
// (at the end of the range) 8 N and − 8 N are left, with errors of 2 N: nrmse = 2/8.
TEST(Comparison, LeavesOutWhatIsClipped) {
  const auto rig = parse_rig(std::string(spring_text) + "[range]\nF = [-11.0, 12.0]\n", "RIG.toml");
  const ChannelComparison F = of(compare(rig, hand_made()), Channel::F);
  EXPECT_EQ(F.clipped, 8U);
  EXPECT_NEAR(F.data_rms, 8.0, 1e-12);
  EXPECT_NEAR(F.nrmse, 0.25, 1e-12);
  std::vector<double> residuals;
  const ComparedRecording compared(rig, hand_made(), StartChoice::automatic);
  compared.residuals(compared.simulate(rig.rig), residuals);
  ASSERT_EQ(residuals.size(), compared.residual_count());
  double squares = 0.0;
  for (const double r : residuals) squares += r * r;
  EXPECT_NEAR(squares, 0.25 * 0.25, 1e-12) << "residuals sum up to nrmse²";

  const auto blind = parse_rig(std::string(spring_text) + "[range]\nF = [-1.0, 1.0]\n", "RIG.toml");
  const ChannelComparison nothing = of(compare(blind, hand_made()), Channel::F);
  EXPECT_EQ(nothing.clipped, 16U);
  EXPECT_TRUE(std::isnan(nothing.nrmse)) << "nothing left to compare";
}

// A channel that never moves has an error, but no normalised one, and does not enter a fit.
TEST(Comparison, HasNoNormalForAChannelThatNeverMoves) {
  const auto rig = parse_rig(spring_text, "RIG.toml");
  Recording recording = hand_made();
  recording[Channel::F].assign(16, 5.0);
  const ComparedRecording compared(rig, recording, StartChoice::automatic);
  EXPECT_EQ(compared.residual_count(), 0U);
  const auto result = compared.compare(compared.simulate(rig.rig));
  EXPECT_TRUE(std::isnan(result.channels[0].nrmse));
  EXPECT_NEAR(result.channels[0].error_rms, std::sqrt((25.0 + 225.0) / 2.0), 1e-12);
}

// Law. The bands are the whole: their squares sum up to the variance of error and data, but for what lies below the
// lowest band (four lines wide): 5 % here, where the body mode is the slowest that is left of either.
TEST(Comparison, SplitsTheErrorIntoBandsThatSumUp) {
  RigDescription rig = support::rig("paper_rig_fdva");
  const Recording recording = simulated(rig, 20000, true);
  rig.rig.tyre.stiffness *= 1.05;
  const RecordingComparison result = compare(rig, recording);
  for (const ChannelComparison& c : result.channels) {
    ASSERT_GT(c.bands.size(), 20U);
    double error = 0.0, data = 0.0;
    for (std::size_t i = 0; i < c.bands.size(); ++i) {
      error += c.bands[i].error_rms * c.bands[i].error_rms;
      data += c.bands[i].data_rms * c.bands[i].data_rms;
      if (i > 0) {
        EXPECT_EQ(c.bands[i].band.lower, c.bands[i - 1].band.upper) << "no gap";
      }
    }
    EXPECT_NEAR(std::sqrt(error) / c.error_rms, 1.0, 0.025) << model::name(c.channel);
    EXPECT_NEAR(std::sqrt(data) / c.data_rms, 1.0, 0.025) << model::name(c.channel);
    EXPECT_LE(std::sqrt(data), c.data_rms * (1.0 + 1e-9));
  }
}

// A wrong tyre shows at the wheel mode, around 12 Hz, and nowhere near as much elsewhere.
TEST(Comparison, ShowsWhereTheErrorLies) {
  RigDescription rig = support::rig("paper_rig_fdva");
  const Recording recording = simulated(rig, 20000, false);
  rig.rig.tyre.stiffness *= 1.05;
  const auto bands = of(compare(rig, recording), Channel::zdd_w).bands;
  const auto worst = std::max_element(bands.begin(), bands.end(),
                                      [](const auto& a, const auto& b) { return a.error_rms < b.error_rms; });
  EXPECT_GT(worst->band.centre, 9.0);
  EXPECT_LT(worst->band.centre, 21.0);
}

// Law. With its own description a simulated recording leaves its noise: the rms of the description ± 4/√(2N), and the
// model's error, below 2e-4 of the signal (response_test), beside it in squares: at most 0.1 %. The inputs are without
// noise here.
TEST(Comparison, LeavesOnlyTheNoiseOfASimulatedRecording) {
  constexpr std::size_t samples = 20000;
  for (const char* name : {"paper_rig_fdva", "paper_bench_fdva"}) {
    RigDescription rig = support::rig(name);
    rig.noise[index(Channel::z_r)] = rig.noise[index(Channel::zdd_r)] = 0.0;
    const RecordingComparison result = compare(rig, simulated(rig, samples, true));
    for (const ChannelComparison& c : result.channels) {
      const double noise = *rig.noise[index(c.channel)];
      EXPECT_NEAR(c.error_rms / noise, 1.0, 4.0 / std::sqrt(2.0 * samples) + 0.003) << name << model::name(c.channel);
      EXPECT_NEAR(c.nrmse, c.error_rms / c.data_rms, 1e-12);
    }
  }
  const auto hil = support::rig("paper_hil_fdva");
  for (const ChannelComparison& c : compare(hil, simulated(hil, samples, false)).channels) {
    EXPECT_LT(c.nrmse, 2e-4) << model::name(c.channel);
  }
}

// A recording cut out of the middle is compared from the state it begins with, by itself; told to start at rest it is
// wrong for seconds.
TEST(Comparison, StartsInMidMotionWhereTheRecordingDoes) {
  const RigDescription rig = support::rig("paper_rig_fdva");
  Recording recording = simulated(rig, 20000, false);
  const RecordingComparison whole = compare(rig, recording);
  EXPECT_TRUE(whole.started_at_rest);
  for (auto* column :
       {&recording.time, &recording[Channel::z_r], &recording[Channel::zdd_r], &recording[Channel::zdd_w],
        &recording[Channel::zdd_b], &recording[Channel::dz_w], &recording[Channel::dz_b], &recording[Channel::F_w]}) {
    column->erase(column->begin(), column->begin() + 7777);
  }
  for (auto& duct : recording.ducts) duct.clear();
  const RecordingComparison cut = compare(rig, recording);
  EXPECT_FALSE(cut.started_at_rest);
  EXPECT_LT(of(cut, Channel::dz_b).nrmse, 0.01);
  const RecordingComparison wrong = compare(rig, recording, StartChoice::rest);
  EXPECT_TRUE(wrong.started_at_rest);
  EXPECT_GT(of(wrong, Channel::dz_b).nrmse, 0.05);
  EXPECT_FALSE(compare(rig, simulated(rig, 2000, false), StartChoice::estimated).started_at_rest);
}

TEST(Comparison, RefusesRecordingsThatCannotBeCompared) {
  const auto rig = parse_rig(spring_text, "RIG.toml");
  const auto refusal = [&rig](const std::function<void(Recording&)>& change) -> std::string {
    Recording recording = hand_made();
    change(recording);
    try {
      const ComparedRecording compared(rig, recording, StartChoice::automatic);
    } catch (const firmware::InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal([](Recording&) {}), "accepted");
  EXPECT_EQ(refusal([](Recording& r) { r[Channel::F].clear(); }),
            "REC.csv: nothing is measured that a component_bench answers with, expected at least one of F");
  EXPECT_NE(refusal([](Recording& r) { r[Channel::x_act].clear(); }).find("x_cmd"), std::string::npos);
  EXPECT_NE(refusal([](Recording& r) {
              r.time.pop_back();
              r[Channel::x_act].pop_back();
              r[Channel::F].pop_back();
            }).find("only 15 samples, expected at least 16"),
            std::string::npos);
}

// Golden. quanser.toml with parameters of an independent linear simulation, whose nrmse the issue states; ± 0.002.
TEST(Comparison, AgreesWithAnIndependentSimulationOfRealMeasurements) {
  const auto folder = support::shared / "real";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "measurements: " << folder << " is missing";
  RigDescription rig = firmware::read_rig(folder / "quanser.toml");
  rig.rig.suspension.stiffness = 3018.617;
  rig.rig.suspension.damping = 59.964;
  rig.rig.tyre.stiffness = 3961.059;
  rig.rig.tyre.damping = 19.249;
  for (const auto& [file, z_w, z_b] :
       {std::tuple{"quanser_1.csv", 0.1271, 0.2077}, std::tuple{"quanser_3.csv", 0.1364, 0.1717}}) {
    const RecordingComparison result =
        compare(rig, host_sim::read_recording(folder / file, rig.channels, rig.sample_rate));
    EXPECT_TRUE(result.started_at_rest);
    EXPECT_NEAR(of(result, Channel::z_w).nrmse, z_w, 0.002) << file;
    EXPECT_NEAR(of(result, Channel::z_b).nrmse, z_b, 0.002) << file;
  }
}

// Every shared recording can be compared with its rig: all kinds, at rest and in mid-motion. What is hidden in the
// samples and what real rigs do beside their linear models leaves less than the signals themselves.
TEST(Comparison, ManagesAllSharedRecordings) {
  if (!std::filesystem::exists(support::shared)) GTEST_SKIP() << "recordings: " << support::shared << " is missing";
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> pairs;
  for (const char* sample : {"a", "b", "c", "d", "e", "f"}) {
    const auto folder = support::shared / "samples" / (std::string("sample_") + sample);
    pairs.emplace_back(folder / "rig.toml", folder / "rec1.csv");
  }
  for (const char* record : {"A1", "A2", "A3"}) {
    const auto folder = support::shared / "real";
    pairs.emplace_back(folder / "mr_damper.toml", folder / (std::string("mr_damper_") + record + ".csv"));
  }
  for (const auto& [rig_file, data] : pairs) {
    const RigDescription rig = firmware::read_rig(rig_file);
    const auto result = compare(rig, host_sim::read_recording(data, rig.channels, rig.sample_rate));
    EXPECT_FALSE(result.channels.empty()) << data;
    for (const auto& c : result.channels) EXPECT_LT(c.nrmse, 1.0) << data << model::name(c.channel);
  }
}

}  // namespace
