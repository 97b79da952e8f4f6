// rigtwin import: the recording, the account of the columns, the mapping in the rig description.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/program.hpp"

namespace {

using model::Channel;
using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;

constexpr const char* bench =
    "kind = \"component_bench\"\nsample_rate = 100.0  # Hz\n[suspension]\nstiffness = 1000.0\ndamping = 100.0\n";

std::string machine_file() {
  std::string text = "Zeit [ms];Stempel [mm];Messdose [kN]\n";
  for (int k = 0; k < 500; ++k) {
    std::array<char, 96> row{};
    std::snprintf(row.data(), row.size(), "%d;%.4f;%.5f\n", 10 * k, 5.0 * std::sin(0.1 * k), 0.3 * std::cos(0.1 * k));
    text += row.data();
  }
  return text;
}

// The whole way: import with guesses, the mapping into the description, the original file in another command.
TEST(Import, WritesARecordingAndAMappingThatOtherCommandsUse) {
  const TemporaryFolder folder;
  const std::string rig = folder.write("rig.toml", bench);
  const std::string file = folder.write("machine.csv", machine_file());
  const std::string out = folder / "rec.csv";
  const Ended ended = rigtwin({"import", file, "--rig", rig, "--out", out, "--write-channels"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_NE(ended.output.find("'Stempel [mm]' looks like x_act in mm"), std::string::npos) << ended.output;
  const firmware::Recording recording = host_sim::read_recording(out, {}, 100.0);
  EXPECT_NEAR(recording[Channel::F][0], 300.0, 1e-9);
  const firmware::RigDescription description = firmware::read_rig(rig);
  EXPECT_EQ(description.channels.at("x_act").column, "Stempel [mm]");
  EXPECT_EQ(description.channels.at("x_act").scale, 1e-3);
  EXPECT_NE(TemporaryFolder::read(rig).find("# Hz"), std::string::npos);
  // Twice gives the same description again, but for nothing.
  const std::string once = TemporaryFolder::read(rig);
  ASSERT_EQ(rigtwin({"import", file, "--rig", rig, "--out", out, "--write-channels"}).status, 0);
  EXPECT_EQ(firmware::read_rig(rig).channels.size(), description.channels.size());
  EXPECT_EQ(rigtwin({"compare", "--rig", rig, "--data", file}).status, 0);
}

TEST(Import, SaysWhatItDidAsJson) {
  const TemporaryFolder folder;
  const Ended ended =
      rigtwin({"import", folder.write("m.csv", machine_file()), "--out", folder / "r.mat", "--json", "-"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const nlohmann::json json = nlohmann::json::parse(ended.output);
  EXPECT_EQ(json["samples"], 500);
  EXPECT_NEAR(json["sample_rate"].get<double>(), 100.0, 1e-9);
  EXPECT_EQ(json["columns"][2]["channel"], "F");
  EXPECT_EQ(json["columns"][2]["scale"], 1000.0);
}

// Errors leave neither a recording nor another description.
TEST(Import, LeavesNothingHalfDone) {
  const TemporaryFolder folder;
  const std::string file = folder.write("machine.csv", machine_file());
  EXPECT_EQ(rigtwin({"import", file, "--out", folder / "x.csv", "--write-channels"}).status, 2);
  EXPECT_EQ(rigtwin({"import", folder / "absent.csv", "--out", folder / "x.csv"}).status, 3);
  EXPECT_EQ(rigtwin({"import", folder.write("empty.csv", ""), "--out", folder / "x.csv"}).status, 3);
  EXPECT_EQ(rigtwin({"import", file, "--out", "/dev/full"}).status, 4);
  const std::string rig = folder.write("rig.toml", std::string(bench) + "[channels.x_act]\ncolumn = \"other\"\n");
  const std::string before = TemporaryFolder::read(rig);
  EXPECT_EQ(rigtwin({"import", file, "--rig", rig, "--out", folder / "x.csv", "--write-channels"}).status, 3);
  EXPECT_EQ(TemporaryFolder::read(rig), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.csv"));
}

// Without --out the columns are listed; names that say nothing are mapped in one command.
TEST(Import, ListsColumnsAndTakesTheUsersWord) {
  const TemporaryFolder folder;
  std::string text = "CHANNEL0,vir\n";
  for (int k = 0; k < 200; ++k) text += std::to_string(k % 20) + ".5," + std::to_string(k % 7) + ".25\n";
  const std::string file = folder.write("raw.csv", text);
  const Ended listed = rigtwin({"import", file, "--json", "-"});
  ASSERT_EQ(listed.status, 0) << listed.errors;
  const nlohmann::json json = nlohmann::json::parse(listed.output);
  EXPECT_EQ(json["columns"][1]["column"], "vir");
  EXPECT_EQ(json["columns"][1]["count"], 200);
  EXPECT_EQ(json["columns"][1]["high"], 6.25);

  const Ended refused = rigtwin({"import", file, "--out", folder / "r.csv"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_NE(refused.errors.find("--map 'x_act=CHANNEL0 [mm]'"), std::string::npos) << refused.errors;
  const Ended ended = rigtwin({"import", file, "--rate", "100", "--map", "x_act=CHANNEL0 [mm] * 10", "--map",
                               "F=vir * 2 + 0.5", "--from", "0.1", "--to", "0.5", "--out", folder / "r.csv"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const firmware::Recording recording = host_sim::read_recording(folder / "r.csv", {}, 100.0);
  ASSERT_EQ(recording.size(), 41U);
  EXPECT_NEAR(recording[Channel::x_act][0], 0.105, 1e-12);
  EXPECT_NEAR(recording[Channel::F][0], 2.0 * 3.25 + 0.5, 1e-12);
  EXPECT_EQ(rigtwin({"import", file, "--map", "speed=vir", "--out", folder / "r.csv"}).status, 2);
  EXPECT_EQ(rigtwin({"import", file, "--map", "F=absent", "--out", folder / "r.csv"}).status, 3);
}

}  // namespace
