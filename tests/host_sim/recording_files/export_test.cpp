// Recordings for other programs: what they read back is what was recorded.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::Recording;
using model::Channel;
using support::TemporaryFolder;

Recording a_recording(std::size_t samples) {
  Recording recording;
  recording.sample_period = 1e-3;
  recording.time = firmware::sample_times(samples, 1000.0);
  for (std::size_t k = 0; k < samples; ++k) {
    recording[Channel::zdd_b].push_back(std::sin(0.1 * static_cast<double>(k)));
    recording[Channel::F_w].push_back(1e3 / (1.0 + static_cast<double>(k)));
  }
  recording.extra.push_back({"late", "s", std::vector<double>(samples, 0.25)});
  return recording;
}

std::string output_of(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> block{};
  for (std::size_t got = 0; (got = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
    text.append(block.data(), got);
  ::pclose(pipe);
  return text;
}

// The tests' own reader of these files is the one that Foxglove is made with.
TEST(Mcap, IsReadByTheFormatsOwnLibrary) {
  const std::filesystem::path reader = support::source / "tests" / "mcap";
  if (!std::filesystem::exists(reader / "node_modules" / "@mcap")) GTEST_SKIP() << "tests/mcap/node_modules is missing";
  const TemporaryFolder folder;
  Recording recording = a_recording(3500);
  recording[Channel::F_w][3] = std::numeric_limits<double>::quiet_NaN();
  host_sim::write_recording(folder / "run.mcap", recording);
  const std::string text =
      output_of("node " + (reader / "read_mcap.mjs").string() + " " + (folder / "run.mcap").string());
  const nlohmann::json read = nlohmann::json::parse(text, nullptr, false);
  ASSERT_TRUE(read.is_object()) << text;
  EXPECT_EQ(read["messages"], 3500);
  EXPECT_EQ(read["stated"], 3500);
  EXPECT_EQ(read["chunks"], 4);  // of a second each
  EXPECT_EQ(read["topics"][0], "/rigtwin");
  EXPECT_EQ(read["firstTime"], 0);
  EXPECT_EQ(read["lastTime"], 3499000000U);
  EXPECT_EQ(read["last"]["F_w"], recording[Channel::F_w][3499]);
  EXPECT_EQ(read["last"]["zdd_b"], recording[Channel::zdd_b][3499]);
  EXPECT_EQ(read["last"]["late"], 0.25);
  EXPECT_EQ(read["schema"]["properties"]["F_w"]["description"], "N");
}

// A spreadsheet's text comes back through the reader of foreign text with the same bits.
TEST(Spreadsheet, ReadsBackToTheSameBits) {
  const TemporaryFolder folder;
  const Recording recording = a_recording(300);
  for (const char* name : {"run.tsv", "run.de.csv"}) {
    host_sim::write_recording(folder / name, recording);
    const std::string text = TemporaryFolder::read(folder / name);
    EXPECT_TRUE(text.starts_with("\xef\xbb\xbft [s]")) << text.substr(0, 40);
    EXPECT_NE(text.find("zdd_b [m/s²]"), std::string::npos);
    const Recording read = host_sim::read_parts(folder / name, {}, 1000.0).front();
    EXPECT_EQ(read.time, recording.time) << name;
    EXPECT_EQ(read[Channel::F_w], recording[Channel::F_w]) << name;
    EXPECT_EQ(read[Channel::zdd_b], recording[Channel::zdd_b]) << name;
  }
}

}  // namespace
