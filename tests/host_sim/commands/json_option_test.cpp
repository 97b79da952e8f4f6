// --json FILE is an option of every command; "-" is standard output, and then nothing else stands there.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace json_option_test {
namespace {

using nlohmann::json;
using support::Ended;
using support::rig_file;
using support::rigtwin;
using support::TemporaryFolder;

TEST(Json, IsAnOptionOfEveryCommand) {
  const Ended ended = rigtwin({"manpage", "--json", "-"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const json all = json::parse(ended.output);
  EXPECT_GE(all["commands"].size(), 17U);
  for (const json& command : all["commands"]) {
    const std::string name = command["name"];
    std::string help;
    for (const json& option : command["options"]) {
      if (option["name"] == "--json") help = option["description"];
    }
    EXPECT_TRUE(help.starts_with("Write ") && help.ends_with(" as JSON (- for standard output)"))
        << name << ": " << help;
  }
}

/// Runs a command with `--json -` and with `--json FILE`: the same JSON, alone on standard output, and beside the text.
json json_of(std::vector<std::string> command) {
  const TemporaryFolder folder;
  const std::string file = folder / "result.json";
  command.insert(command.end(), {"--json", "-"});
  const Ended alone = rigtwin(command);
  EXPECT_EQ(alone.status, 0) << alone.errors;
  command.back() = file;
  const Ended beside = rigtwin(command);
  EXPECT_EQ(beside.status, 0) << beside.errors;
  EXPECT_FALSE(beside.output.empty());
  EXPECT_NE(beside.output.front(), '{');
  json written = json::parse(TemporaryFolder::read(file), nullptr, false),
       printed = json::parse(alone.output, nullptr, false);
  EXPECT_FALSE(printed.is_discarded()) << alone.output;
  // The two differ in --json alone; a command that writes its input changes its hash.
  EXPECT_EQ(support::without_origin(written), support::without_origin(printed));
  return printed;
}

// --quiet leaves errors and what "-" asks for; --verbose shows progress where there is no terminal, too.
TEST(Json, StaysUnderQuiet) {
  const TemporaryFolder folder;
  const std::string rig = rig_file("paper_linear"), data = folder / "run.csv";
  const auto with = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {name, "--rig", rig, name == "simulate" ? "--out" : "--data", data});
    return rigtwin(more);
  };
  const Ended made = with("simulate", {"--duration", "3", "--quiet"});
  EXPECT_EQ(made.status, 0) << made.errors;
  EXPECT_EQ(made.output + made.errors, "");
  EXPECT_GT(std::filesystem::file_size(data), 1000U);
  EXPECT_EQ(json::parse(with("compare", {"--quiet", "--json", "-"}).output)["schema"], "rigtwin/compare/1");
  const auto plan =
      folder.write("plan.toml", "rig = \"" + rig + "\"\n[run]\nduration = 0.2\n[vary]\nspeed = [10.0, 20.0]\n");
  const Ended usual = rigtwin({"sweep", plan, "--out", folder / "one"}),
              verbose = rigtwin({"sweep", plan, "--out", folder / "two", "--verbose"});
  EXPECT_EQ(usual.errors, "");
  EXPECT_NE(verbose.errors.find("sweep 100 % 2 of 2 cases\n"), std::string::npos) << verbose.errors;
  EXPECT_EQ(with("compare", {"--quiet", "--verbose"}).status, 2);
}

TEST(Json, SaysTheCommands) { EXPECT_EQ(json_of({"completion"})["program"], "rigtwin"); }

TEST(Json, SaysTheCardOfAnEffect) {
  const json card = json_of({"diagnose", "--explain", "coulomb_friction"});
  EXPECT_EQ(card["name"], "coulomb_friction");
  EXPECT_EQ(card["parameters"][0]["unit"], "N");
  EXPECT_EQ(card["rigs"].size(), 3U);
}

TEST(Json, SaysTheLimitsOfALoop) {
  const TemporaryFolder folder;
  const auto rig = folder.write("rig.toml", TemporaryFolder::read(rig_file("paper_hil_fdva")));
  const json limits = json_of({"stability", "--write-limits", rig});
  EXPECT_GT(limits["allowed_delay"], 0.0);
  EXPECT_GT(limits["allowed_gain"], 1.0);
  EXPECT_NE(TemporaryFolder::read(rig).find(limits["proven"]), std::string::npos);
}

TEST(Json, SaysTheWorkOfAShard) {
  const TemporaryFolder folder;
  folder.write("rig.toml", TemporaryFolder::read(rig_file("paper_linear")));
  const auto plan = folder.write(
      "plan.toml", "rig = \"rig.toml\"\n[run]\nduration = 0.2\n[vary]\nspeed = [10.0, 15.0, 20.0, 30.0]\n");
  const Ended ended = rigtwin({"sweep", plan, "--out", folder / "results", "--shard", "1/2", "--json", "-"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const json work = json::parse(ended.output);
  EXPECT_EQ(work["cases"], 2);
  EXPECT_EQ(work["computed"], 2);
  EXPECT_EQ(work["all_cases"], 4);
}

TEST(Json, SaysThePaper) {
  const TemporaryFolder folder;
  const json paper = json_of({"paper", "--out", folder / "paper"});
  const json written = json::parse(TemporaryFolder::read(folder.path() / "paper" / "paper.json"));
  EXPECT_EQ(support::without_origin(paper), support::without_origin(written));
}

}  // namespace
}  // namespace json_option_test
