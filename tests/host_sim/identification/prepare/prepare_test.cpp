// Recordings as a user brings them become recordings that can be compared with simulations.
#include "host_sim/identification/prepare/prepare.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"
#include "host_sim/identification/prepare/recording_window.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

// Point. A cut recording holds the window of every column, and nothing of a column that is not there.
TEST(RecordingWindow, CutsEveryColumn) {
  const firmware::Recording whole = sample::recorded(sample::bench());
  const firmware::Recording part = cut(whole, {100, 350});
  EXPECT_EQ((Window{100, 350}.size()), 250U);
  ASSERT_EQ(part.size(), 250U);
  EXPECT_EQ(part.time.front(), whole.time[100]);
  for (const Channel channel : {Channel::x_cmd, Channel::x_act, Channel::F}) {
    ASSERT_EQ(part[channel].size(), 250U);
    EXPECT_EQ(part[channel].front(), whole[channel][100]);
    EXPECT_EQ(part[channel].back(), whole[channel][349]);
  }
  EXPECT_FALSE(part.has(Channel::z_r));
  EXPECT_EQ(part.source, whole.source);
}

// Point. A quarter is held out where a recording is shared; a command is exact, so the input carries no noise; declared
// noise is believed.
TEST(PreparedRecording, SplitsOffAQuarter) {
  const firmware::RigDescription bench = sample::bench();
  const PreparedRecording shared = prepare_recording(bench, sample::recorded(bench), Use::shared, false);
  EXPECT_EQ(shared.channels, (std::vector<Channel>{Channel::x_act, Channel::F}));
  EXPECT_EQ(shared.fitted.size(), 6000U);
  EXPECT_EQ(shared.held_out.from, 6000U);
  EXPECT_EQ(shared.held_out.to, 8000U);
  EXPECT_EQ(shared.input_noise.position, 0.0);
  EXPECT_EQ(shared.noise[index(Channel::F)], sample::force_noise);
  EXPECT_EQ(shared.substeps, 4) << "quarters of a millisecond";
  EXPECT_TRUE(shared.explains(Channel::F));
  EXPECT_FALSE(shared.explains(Channel::x_cmd));
  EXPECT_EQ(prepare_recording(bench, sample::recorded(bench), Use::fitted, false).held_out.size(), 0U);
  EXPECT_EQ(prepare_recording(bench, sample::recorded(bench), Use::held_out, false).fitted.size(), 0U);
  EXPECT_THROW((void)prepare_recording(bench, sample::recorded(bench, 2.4), Use::fitted, false), firmware::InputError);
}

// Point. Samples outside the measuring range are marked, and those alone.
TEST(PreparedRecording, MarksClippedSamples) {
  firmware::RigDescription bench = sample::bench();
  bench.range[index(Channel::F)] = {-200.0, 200.0};
  firmware::Recording recording = sample::recorded(bench);
  const std::vector<double> force = recording[Channel::F];
  const PreparedRecording prepared = prepare_recording(bench, std::move(recording), Use::fitted, false);
  const auto& clipped = prepared.clipped[index(Channel::F)];
  ASSERT_EQ(clipped.size(), force.size());
  for (std::size_t k = 0; k < force.size(); ++k) ASSERT_EQ(clipped[k], std::abs(force[k]) >= 200.0) << k;
  EXPECT_TRUE(prepared.clipped[index(Channel::x_act)].empty());
}

// Point. A hil rig is explained as the bench that its machine makes; other rigs as they are.
TEST(PreparedRecording, ExplainsTheBenchOfAHilRig) {
  const firmware::RigDescription hil = firmware::parse_rig(support::hil_text, "hil");
  EXPECT_EQ(explained_part(hil.rig).kind, model::RigKind::component_bench);
  EXPECT_EQ(explained_part(hil.rig).machine.virtual_damping, 0.0);
  EXPECT_EQ(explained_part(sample::bench().rig).kind, model::RigKind::component_bench);
}

// Law. Where the command of a hil rig stands still, F is what its virtual car asks for: not compared, and two samples on
// either side, and it is said. A bench that stands still says its stiffness.
TEST(PreparedRecording, ComparesNoForceOfACommandThatStandsStill) {
  firmware::RigDescription hil = firmware::parse_rig(support::hil_text, "hil");
  firmware::Recording stuck = sample::recorded(sample::bench());
  for (std::size_t k = 1001; k <= 1010; ++k) stuck[Channel::x_cmd][k] = stuck[Channel::x_cmd][1000];
  for (const Channel of_a_car : {Channel::z_r, Channel::z_w, Channel::z_b}) stuck[of_a_car] = stuck[Channel::x_cmd];
  const PreparedRecording prepared = prepare_recording(hil, stuck, Use::fitted, false);
  const std::vector<bool>& unused = prepared.clipped[index(Channel::F)];
  ASSERT_EQ(unused.size(), 8000U);
  for (std::size_t k = 0; k < unused.size(); ++k) ASSERT_EQ(unused[k], k >= 998 && k <= 1012) << k;
  EXPECT_EQ(prepared.stuck, 15U);
  const PreparedData data = prepare(hil, {{stuck, Use::fitted}});
  const auto says = [&](const char* words) {
    return std::count_if(data.remarks.begin(), data.remarks.end(),
                         [&](const std::string& remark) { return remark.find(words) != std::string::npos; });
  };
  EXPECT_EQ(says("x_cmd stands still in 15 samples"), 1);
  EXPECT_EQ(says("clipped"), 0);
  for (const Channel of_a_car : {Channel::z_r, Channel::z_w, Channel::z_b}) stuck[of_a_car].clear();
  EXPECT_TRUE(prepare_recording(sample::bench(), stuck, Use::fitted, false).clipped[index(Channel::F)].empty());
}

// Law. Of 500 s the first 120 s are fitted and the last 40 s held out, as a recording of their own, and it is said.
TEST(Prepare, LeavesOutTheMiddleOfALongRecording) {
  const firmware::RigDescription bench = sample::bench();
  std::vector<Record> records;
  records.push_back({sample::recorded(bench, 500.0), Use::shared});
  const PreparedData data = prepare(bench, std::move(records));
  ASSERT_EQ(data.recordings.size(), 2U);
  EXPECT_EQ(data.recordings[0].fitted.size(), 120'000U);
  EXPECT_EQ(data.recordings[0].held_out.size(), 0U);
  EXPECT_EQ(data.recordings[1].held_out.size(), 40'000U - 300U) << "it begins in motion: the machine settles first";
  EXPECT_NEAR(data.recordings[1].recording.time.front(), 460.0, 1e-9);
  ASSERT_EQ(data.remarks.size(), 1U);
  EXPECT_NE(data.remarks[0].find("of 500 s the first 120 s are fitted, the last 40 s held out"), std::string::npos);
}

// Something must be fitted, and all recordings must measure the same.
TEST(Prepare, RefusesWhatCannotBeFittedTogether) {
  const firmware::RigDescription bench = sample::bench();
  std::vector<Record> held_out;
  held_out.push_back({sample::recorded(bench), Use::held_out});
  EXPECT_THROW((void)prepare(bench, std::move(held_out)), firmware::InputError);
  std::vector<Record> different;
  different.push_back({sample::recorded(bench), Use::fitted});
  different.push_back({sample::recorded(bench), Use::fitted});
  different[1].recording[Channel::x_act].clear();
  EXPECT_THROW((void)prepare(bench, std::move(different)), firmware::InputError);
}

}  // namespace
