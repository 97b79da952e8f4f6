// Commands that leave a page, and the two lists that say what words mean.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.hpp"
#include "tests/support/report_page.hpp"
#include "tests/support/rig_texts.hpp"

namespace pages_command_test {
namespace {

using nlohmann::json;
using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;
using testing::HasSubstr;

class Pages : public ::testing::Test {
 protected:
  void SetUp() override {
    const Ended made =
        rigtwin({"simulate", "--rig", rig_, "--duration", "8", "--out", at("run.csv"), "--report", at("run.html")});
    ASSERT_EQ(made.status, 0) << made.errors;
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t figures(const std::string& name) const {
    return support::figures_of(TemporaryFolder::read(folder_ / name)).size();
  }
  TemporaryFolder folder_;
  std::string rig_ = support::rig_file("paper_rig_fdva");
};

// Journey. Each page has its figures, and its first sentence says what it is about.
TEST_F(Pages, AreLeftByEachCommand) {
  EXPECT_EQ(figures("run.html"), 3U);  // traces, spectra, responses
  const Ended shown = rigtwin(
      {"show", at("run.csv"), at("run.csv"), "--rig", rig_, "--report", at("show.html"), "--json", at("show.json")});
  ASSERT_EQ(shown.status, 0) << shown.errors;
  EXPECT_THAT(shown.output, HasSubstr("run.csv: 8 s at 1000 Hz, 7 channels."));
  EXPECT_EQ(figures("show.html"), 3U);
  EXPECT_THAT(TemporaryFolder::read(folder_ / "show.html"), HasSubstr("model paper_rig_fdva.toml"));
  EXPECT_EQ(json::parse(TemporaryFolder::read(folder_ / "show.json"))["recordings"].size(), 2U);

  const Ended compared = rigtwin({"compare", "--rig", rig_, "--data", at("run.csv"), "--report", at("compare.html")});
  ASSERT_EQ(compared.status, 0) << compared.errors;
  EXPECT_EQ(figures("compare.html"), 4U);  // traces, bands, scatter, spectra
  EXPECT_THAT(TemporaryFolder::read(folder_ / "compare.html"), HasSubstr("The model of paper_rig_fdva.toml leaves"));

  const Ended responses =
      rigtwin({"frf", "--data", at("run.csv"), "--input", "z_r", "--output", "F_w", "--report", at("frf.html")});
  ASSERT_EQ(responses.status, 0) << responses.errors;
  EXPECT_EQ(figures("frf.html"), 1U);
  EXPECT_THAT(TemporaryFolder::read(folder_ / "frf.html"), HasSubstr("is largest at"));
}

// A machine 10 ms late: led by its inverse it would have followed.
TEST_F(Pages, IsLeftByAMachinesRecord) {
  const std::string hil = support::rig_file("paper_hil_fdva");
  ASSERT_EQ(rigtwin({"simulate", "--rig", hil, "--duration", "6", "--out", at("hil.csv")}).status, 0);
  const Ended examined =
      rigtwin({"compensation", "--rig", hil, "--data", at("hil.csv"), "--report", at("machine.html")});
  ASSERT_EQ(examined.status, 0) << examined.errors;
  EXPECT_EQ(figures("machine.html"), 2U);
  EXPECT_THAT(TemporaryFolder::read(folder_ / "machine.html"), HasSubstr("The machine missed its command by"));
}

TEST_F(Pages, IsLeftByASweep) {
  std::ofstream(folder_ / "plan.toml") << "rig = \"" << rig_
                                       << "\"\n[run]\nduration = 2.0\n[vary]\nspeed = [15.0, "
                                          "25.0]\nopen_ducts = [0, 2]\n";
  const Ended swept = rigtwin({"sweep", at("plan.toml"), "--out", at("results"), "--report", at("sweep.html")});
  ASSERT_EQ(swept.status, 0) << swept.errors;
  const std::string page = TemporaryFolder::read(folder_ / "sweep.html");
  EXPECT_THAT(page, HasSubstr("4 cases, none failed"));
  EXPECT_THAT(page, HasSubstr("over open_ducts and speed"));
  EXPECT_GE(figures("sweep.html"), 4U);
}

// The glossary: every channel with sign, unit and rigs; of one kind only those that it has.
TEST(Lists, SayWhatChannelsAndEffectsAre) {
  const Ended all = rigtwin({"channels"});
  EXPECT_EQ(all.status, 0) << all.errors;
  for (const char* word : {"z_r", "F_act", "dynamic wheel load", "compressed", "m/s²", "component_bench"}) {
    EXPECT_THAT(all.output, HasSubstr(word));
  }
  const json bench = json::parse(rigtwin({"channels", "--kind", "component_bench", "--json", "-"}).output)["channels"];
  ASSERT_EQ(bench.size(), 3U);
  EXPECT_EQ(bench[0]["name"], "x_cmd");
  EXPECT_EQ(rigtwin({"channels", "--kind", "truck"}).status, 2);
  const json effects = json::parse(rigtwin({"effects", "--json", "-"}).output)["effects"];
  EXPECT_GE(effects.size(), 35U);
  EXPECT_THAT(rigtwin({"effects"}).output, HasSubstr("coulomb_friction"));
}

// Templates name only channels that the kind has.
TEST(Lists, InitNamesChannelsOfTheKind) {
  const TemporaryFolder folder;
  for (const std::string kind : {"hil", "component_bench", "quarter_car"}) {
    const std::string file = (folder / (kind + ".toml")).string();
    ASSERT_EQ(rigtwin({"init", "--kind", kind, "--out", file}).status, 0);
    const std::string text = TemporaryFolder::read(folder / (kind + ".toml"));
    EXPECT_EQ(text.find("# z_r = ") != std::string::npos, kind == "quarter_car") << text;
    EXPECT_EQ(text.find("# F = ") != std::string::npos, kind != "quarter_car") << text;
  }
}

}  // namespace
}  // namespace pages_command_test
