// Files as instruments left them: what comes out is what was converted by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>

#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::ChannelMap;
using firmware::Recording;
using model::Channel;

const std::filesystem::path& real() {
  static const std::filesystem::path folder = support::shared / "real";
  return folder;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Equal but for a constant (the hand-made files have their means taken off) and the digits that were printed.
void expect_equal_up_to_a_constant(const std::vector<double>& imported, const std::vector<double>& by_hand,
                                   double tolerance) {
  ASSERT_LE(imported.size(), by_hand.size());
  const double constant = imported[0] - by_hand[0];
  for (std::size_t k = 0; k < imported.size(); ++k) ASSERT_NEAR(imported[k] - constant, by_hand[k], tolerance) << k;
}

TEST(RealFiles, AnMtsExportGivesTheRecordingMadeByHand) {
  if (!std::filesystem::exists(real())) GTEST_SKIP() << real() << " is missing";
  const ChannelMap map{
      {"x_act", {"CHANNEL0", 0.01, 0.0}}, {"F", {"CHANNEL1", 9806.65, 0.0}}, {"x_cmd", {"CHANNEL2", 0.01, 0.0}}};
  const host_sim::Import import =
      host_sim::import_file(real() / "raw" / "mts_0A.txt", {map, 1000.0, model::RigKind::component_bench});
  const Recording by_hand = host_sim::read_recording(real() / "mts_0A.csv", {}, 1000.0);
  ASSERT_EQ(import.recording.size(), 6000U);
  EXPECT_EQ(import.recording.time[5999], 5.999);
  EXPECT_TRUE(import.notes.size() == 1) << import.notes.back();
  // Seven printed digits.
  expect_equal_up_to_a_constant(import.recording[Channel::x_act], by_hand[Channel::x_act], 2e-9);
  expect_equal_up_to_a_constant(import.recording[Channel::x_cmd], by_hand[Channel::x_cmd], 2e-9);
  expect_equal_up_to_a_constant(import.recording[Channel::F], by_hand[Channel::F], 2e-3);
}

TEST(RealFiles, MatlabVectorsUnderOtherNamesGiveTheRecordingMadeByHand) {
  if (!std::filesystem::exists(real())) GTEST_SKIP() << real() << " is missing";
  const ChannelMap map{{"x_act", {"qm", 1.0, 0.0}}, {"F", {"vir", 35.1506832, 0.0}}};
  const Recording recording = host_sim::read_parts(real() / "raw" / "DATA_EMPS.mat", map, 1000.0).front();
  const Recording by_hand = host_sim::read_recording(real() / "emps_1.csv", {}, 1000.0);
  ASSERT_EQ(recording.size(), by_hand.size());
  for (std::size_t k = 0; k < recording.size(); ++k) {
    ASSERT_NEAR(recording[Channel::x_act][k], by_hand[Channel::x_act][k], 1e-8) << k;
    // The file's own gtau is the factor; the tolerance is its sixth digit.
    ASSERT_NEAR(recording[Channel::F][k], by_hand[Channel::F][k], 1e-3) << k;
  }
}

// Names 'Tout', 'dist', 'forc' and millimetres are guessed; a rig with [channels] is not needed.
TEST(RealFiles, ADamperRecordIsUnderstoodByItsNames) {
  if (!std::filesystem::exists(real())) GTEST_SKIP() << real() << " is missing";
  const Recording recording =
      host_sim::read_parts(real() / "raw" / "ensaio.A.1.mat", {}, 100.0, model::RigKind::component_bench).front();
  const Recording by_hand = host_sim::read_recording(real() / "mr_damper_A1.csv", {}, 100.0);
  ASSERT_EQ(recording.size(), by_hand.size());
  expect_equal_up_to_a_constant(recording[Channel::x_act], by_hand[Channel::x_act], 1e-8);
  expect_equal_up_to_a_constant(recording[Channel::F], by_hand[Channel::F], 1e-4);
  EXPECT_NEAR(mean(by_hand[Channel::F]), 0.0, 1.0);
  EXPECT_NE(recording.remark.find("'dist' looks like x_act in mm"), std::string::npos) << recording.remark;
}

// A file without any header: columns by number, uneven milliseconds, a pause.
TEST(RealFiles, ATableWithoutNamesIsReadByColumnNumbers) {
  if (!std::filesystem::exists(real())) GTEST_SKIP() << real() << " is missing";
  const ChannelMap map{{"x_act", {"column 5", 1e-3, 0.0}}, {"F", {"column 7", 1.0, 0.0}}};
  const host_sim::Import import =
      host_sim::import_file(real() / "raw" / "pneumatic.csv", {map, 100.0, model::RigKind::component_bench});
  EXPECT_NEAR(import.recording.time.front(), 0.0, 1e-12);
  EXPECT_NEAR(import.recording[Channel::x_act].front(), -0.009e-3, 1e-12);
  EXPECT_NEAR(import.recording[Channel::F].front(), 49.749, 1e-9);
  EXPECT_GT(import.recording.size(), 390U);
  std::string notes;
  for (const std::string& note : import.notes) notes += note + "; ";
  EXPECT_NE(notes.find("time in ms"), std::string::npos) << notes;
  EXPECT_NE(notes.find("gap is kept"), std::string::npos) << notes;
}

}  // namespace
