// rigtwin diagnose as a shell meets it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host_sim/catalogue.hpp"
#include "host_sim/rig_writer.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using support::rigtwin;
using support::TemporaryFolder;

/// A recording of a bench with dry friction, its description without; both in the folder.
class DiagnoseCommand : public testing::Test {
 protected:
  void SetUp() override {
    host_sim::RigDescription description = support::rig("paper_bench_fdva");
    remove_effect(description.rig, *host_sim::find_effect("coulomb_friction"), std::nullopt);
    description.noise[index(model::Channel::F)] = 10.0;
    description.noise[index(model::Channel::x_act)] = 2e-5;
    folder.write("bench.toml", format_rig(description));
    description.rig.effects.add(model::CoulombFriction<double>{60.0});
    folder.write("truth.toml", format_rig(description));
    const auto made = rigtwin({"simulate", "--rig", (folder / "truth.toml").string(), "--duration", "10", "--out",
                               (folder / "rec.csv").string()});
    ASSERT_EQ(made.status, 0) << made.errors;
  }
  [[nodiscard]] support::Ended run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"diagnose", "--rig", (folder / "bench.toml").string(), "--data",
                                   (folder / "rec.csv").string()};
    words.insert(words.end(), more.begin(), more.end());
    return rigtwin(words);
  }

  TemporaryFolder folder;
};

// The whole way: a verdict for scripts, a page, a rig that the other commands take and that leaves noise alone.
TEST_F(DiagnoseCommand, LeavesVerdictReportAndRig) {
  const auto out = folder / "out";
  const auto ended = run({"--out", out.string()});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_NE(ended.output.find("coulomb_friction"), std::string::npos) << ended.output;
  const auto verdict = nlohmann::json::parse(TemporaryFolder::read(out / "verdict.json"));
  EXPECT_EQ(verdict["verdict"], "named");
  ASSERT_EQ(verdict["effects"].size(), 1U);
  const auto& effect = verdict["effects"][0];
  EXPECT_EQ(effect["name"], "coulomb_friction");
  EXPECT_NEAR(effect["parameters"]["force"]["value"].get<double>(), 60.0, 0.6);
  EXPECT_LT(effect["parameters"]["force"]["ci95"][0], effect["parameters"]["force"]["ci95"][1]);
  EXPECT_GT(effect["confidence"], 0.9);
  EXPECT_FALSE(effect["alternatives"].empty());
  EXPECT_LT(verdict["gap"]["F"]["after"].get<double>(), 1.15 * verdict["gap"]["F"]["noise_floor"].get<double>());
  EXPECT_GT(verdict["gap"]["F"]["before"].get<double>(), 2.0 * verdict["gap"]["F"]["after"].get<double>());
  EXPECT_EQ(verdict["unexplained"], false);
  EXPECT_NE(TemporaryFolder::read(out / "report.html").find("coulomb_friction"), std::string::npos);

  const auto again =
      rigtwin({"compare", "--rig", (out / "rig.toml").string(), "--data", (folder / "rec.csv").string()});
  EXPECT_EQ(again.status, 0) << again.errors;
  EXPECT_EQ(rigtwin({"simulate", "--rig", (out / "rig.toml").string(), "--duration", "1", "--out",
                     (folder / "again.csv").string()})
                .status,
            0);
  // The folder is ours: it may be written again.
  EXPECT_EQ(run({"--out", out.string()}).status, 0);
}

// Each mistake is one line and the contract's status; the description that was given is never overwritten.
TEST_F(DiagnoseCommand, TellsMistakesInOneLine) {
  const std::string before = TemporaryFolder::read(folder / "bench.toml");
  folder.write("rig.toml", before);
  const auto refused = [](const support::Ended& ended, int status, const std::string& words) {
    EXPECT_EQ(ended.status, status) << words;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(words), std::string::npos) << ended.errors;
  };
  refused(run({"--out", folder.path().string()}), 4, "was not written by rigtwin diagnose");
  EXPECT_EQ(TemporaryFolder::read(folder / "rig.toml"), before);
  refused(run({"--out", (folder / "bench.toml").string()}), 4, "is no folder");
  refused(run({}), 2, "--out");
  refused(rigtwin({"diagnose", "--explain", "top_mont"}), 2, "top_mount");
  folder.write("short.csv", "t,x_cmd,x_act,F\n0,0,0,0\n0.001,0,0,0\n0.002,0,0,0\n");
  refused(rigtwin({"diagnose", "--rig", (folder / "bench.toml").string(), "--data", (folder / "short.csv").string(),
                   "--out", (folder / "o").string()}),
          3, "at least 5 s");
  EXPECT_EQ(rigtwin({"diagnose", "--explain", "top_mount"}).status, 0);
}

}  // namespace
