// rigtwin sweep as a shell and a cluster meet it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using support::rigtwin;
using support::TemporaryFolder;

std::string write_plan(const TemporaryFolder& folder, const std::string& more = {}) {
  folder.write("car.toml", TemporaryFolder::read(support::rig_file("paper_rig_fdva")));
  return folder
      .write("plan.toml",
             "rig = \"car.toml\"\n[run]\nduration = 0.2\n[vary]\nspeed = [10.0, 20.0, "
             "30.0]\n\"suspension.damping\" = [500.0, -5.0, 1500.0]\n" +
                 more)
      .string();
}

// Journey. A case is what `rigtwin simulate` gives with the rig, road and seed of its line, to the last digit shown.
TEST(SweepCommand, RunsWhatSimulateRuns) {
  const TemporaryFolder folder;
  const std::string plan = write_plan(folder), out = (folder / "results").string();
  const auto ended = rigtwin({"sweep", plan, "--out", out, "--json", "-"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const auto summary = nlohmann::json::parse(ended.output);
  EXPECT_EQ(summary["cases"], 9);
  EXPECT_EQ(summary["failed"], 3) << "a negative damping is no rig";
  EXPECT_GT(summary["numbers"]["rms_F_w"]["mean"], 10.0);
  std::ifstream lines(folder / "results" / "results.jsonl");
  std::string text;
  for (int i = 0; i <= 5; ++i) std::getline(lines, text);
  const auto line = nlohmann::json::parse(text);
  ASSERT_EQ(line["id"], 5);
  EXPECT_EQ(line["suspension.damping"], 1500.0);
  std::string rig = TemporaryFolder::read(folder / "car.toml");
  const std::string described = "damping = 1140.0";
  ASSERT_NE(rig.find(described), std::string::npos);
  rig.replace(rig.find(described), described.size(), "damping = 1500.0");
  folder.write("case.toml", rig);
  const auto run =
      rigtwin({"simulate", "--rig", (folder / "case.toml").string(), "--speed", "20", "--duration", "0.2", "--seed",
               std::to_string(line["seed"].get<std::uint64_t>()), "--out", (folder / "run.csv").string()});
  ASSERT_EQ(run.status, 0) << run.errors;
  char shown[64];
  std::snprintf(shown, sizeof shown, "%12.5g %12.5g %12.5g", line["rms_F_w"].get<double>(),
                line["lowest_F_w"].get<double>(), line["highest_F_w"].get<double>());
  EXPECT_NE(run.output.find(shown), std::string::npos) << run.output << "\n" << text;
}

// Journey. Shards by flag and by an engine's variables are merged to the bytes of one process.
TEST(SweepCommand, IsTheSameInShards) {
  const TemporaryFolder folder;
  const std::string plan = write_plan(folder), whole = (folder / "whole").string(), out = (folder / "out").string();
  ASSERT_EQ(rigtwin({"sweep", plan, "--out", whole}).status, 0);
  ASSERT_EQ(rigtwin({"sweep", plan, "--out", out, "--shard", "1/2"}).status, 0);
  const auto early = rigtwin({"sweep", "--merge", out});
  EXPECT_EQ(early.status, 3);
  EXPECT_EQ(early.error_lines(), 1);
  EXPECT_NE(early.errors.find("5 of 9 cases are missing, the first is 0"), std::string::npos) << early.errors;
  ::setenv("OMPI_COMM_WORLD_RANK", "0", 1);
  ::setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
  const auto by_rank = rigtwin({"sweep", plan, "--out", out});
  ::unsetenv("OMPI_COMM_WORLD_RANK");
  ::unsetenv("OMPI_COMM_WORLD_SIZE");
  ASSERT_EQ(by_rank.status, 0) << by_rank.errors;
  EXPECT_NE(by_rank.output.find("shard 0/2: 5 of 9 cases, 5 computed now"), std::string::npos) << by_rank.output;
  ASSERT_EQ(rigtwin({"sweep", "--merge", out}).status, 0);
  for (const char* name : {"results.csv", "results.jsonl"}) {
    EXPECT_EQ(TemporaryFolder::read(folder / "out" / name), TemporaryFolder::read(folder / "whole" / name)) << name;
  }
}

TEST(SweepCommand, RefusesInOneLine) {
  const TemporaryFolder folder;
  const std::string plan = write_plan(folder), out = (folder / "out").string();
  struct Wrong {
    std::vector<std::string> options;
    int status;
    std::string says;
  };
  const std::vector<Wrong> all{{{}, 2, "expected rigtwin sweep PLAN.toml"},
                               {{plan}, 2, "expected rigtwin sweep PLAN.toml"},
                               {{plan, "--out", out, "--shard", "3/2"}, 2, "is no shard"},
                               {{plan, "--out", out, "--merge", out}, 2, "--merge takes"},
                               {{plan, "--out", out, "--jobs", "0"}, 2, "--jobs"},
                               {{"/nowhere/plan.toml", "--out", out}, 3, "cannot be opened"},
                               {{plan, "--out", "/dev/null/out"}, 4, "cannot be made"},
                               {{"--merge", "/nowhere"}, 3, "cannot be listed"}};
  for (const Wrong& wrong : all) {
    std::vector<std::string> arguments{"sweep"};
    arguments.insert(arguments.end(), wrong.options.begin(), wrong.options.end());
    const auto ended = rigtwin(arguments);
    EXPECT_EQ(ended.status, wrong.status) << wrong.says << ": " << ended.errors;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(wrong.says), std::string::npos) << ended.errors;
  }
}

}  // namespace
