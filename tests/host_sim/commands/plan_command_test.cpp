// rigtwin plan as a shell meets it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using support::rigtwin;
using support::TemporaryFolder;

TEST(PlanCommand, PrintsAndWritesWhatTheRecordingWouldShow) {
  const TemporaryFolder folder;
  const auto json = folder / "plan.json", page = folder / "plan.html";
  const auto ended = rigtwin({"plan", "--rig", support::rig_file("paper_bench_fdva"), "--duration", "8", "--without",
                              "x_act", "--level", "0.8", "--json", json.string(), "--report", page.string()});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_TRUE(ended.errors.empty()) << ended.errors;
  EXPECT_NE(ended.output.find("bump_stop"), std::string::npos) << ended.output;
  const auto plan = nlohmann::json::parse(TemporaryFolder::read(json));
  EXPECT_EQ(plan["channels"], nlohmann::json({"F"}));
  EXPECT_GT(plan["effects"].size(), 10U);
  EXPECT_NE(TemporaryFolder::read(page).find("</html>"), std::string::npos);
  const auto only = rigtwin(
      {"plan", "--rig", support::rig_file("paper_bench_fdva"), "--duration", "8", "--without", "x_act", "--json", "-"});
  ASSERT_EQ(only.status, 0) << only.errors;
  EXPECT_TRUE(nlohmann::json::parse(only.output).contains("advice"));
}

TEST(PlanCommand, RefusesInOneLine) {
  struct Wrong {
    std::vector<std::string> options;
    int status;
    std::string says;
  };
  const std::vector<Wrong> all{{{"--without", "G"}, 2, "unknown channel 'G'"},
                               {{"--without", "F_w"}, 2, "has no channel F_w"},
                               {{"--without", "F,x_act"}, 3, "nothing is measured"},
                               {{"--without", "x_cmd,F,x_act"}, 3, "expected"},
                               {{"--road", "/nowhere/road.csv"}, 3, "cannot be opened"},
                               {{"--road", "iso8608:Q"}, 2, "Q"},
                               {{"--duration", "1"}, 2, "--duration"},
                               {{"--level", "nan"}, 2, "--level"},
                               {{"--json", "/nowhere/plan.json"}, 4, "/nowhere/plan.json"}};
  for (const Wrong& wrong : all) {
    std::vector<std::string> arguments{"plan", "--rig", support::rig_file("paper_bench_fdva")};
    if (wrong.options.front() != "--duration") arguments.insert(arguments.end(), {"--duration", "6"});
    arguments.insert(arguments.end(), wrong.options.begin(), wrong.options.end());
    const auto ended = rigtwin(arguments);
    EXPECT_EQ(ended.status, wrong.status) << wrong.options.back() << ": " << ended.errors;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(wrong.says), std::string::npos) << ended.errors;
    EXPECT_TRUE(ended.output.empty());
  }
}

}  // namespace
