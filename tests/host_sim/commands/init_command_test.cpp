// rigtwin init, completion and manpage: the first steps of a user.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;

// Every kind that init writes is a rig that simulate takes, with the numbers that were given.
TEST(Init, WritesARigThatRuns) {
  for (const char* kind : {"quarter_car", "hil", "component_bench"}) {
    SCOPED_TRACE(kind);
    const TemporaryFolder folder;
    const std::string rig = folder / "rig.toml";
    const Ended made = rigtwin(
        {"init", "--kind", kind, "--suspension-stiffness", "28000", "--sample-rate", "500", "--fdva", "--out", rig});
    ASSERT_EQ(made.status, 0) << made.errors;
    const firmware::RigDescription description = firmware::read_rig(rig);
    EXPECT_EQ(description.rig.suspension.stiffness, 28000.0);
    EXPECT_EQ(description.sample_rate, 500.0);
    EXPECT_TRUE(description.rig.has_fdva);
    const Ended run = rigtwin({"simulate", "--rig", rig, "--duration", "0.2", "--out", folder / "run.csv"});
    EXPECT_EQ(run.status, 0) << run.errors;
  }
}

// A template of a mass that a force drives: simulated, compared and refused where a machine or a loop is needed.
TEST(Init, WritesAMassThatAForceDrives) {
  const TemporaryFolder folder;
  const std::string rig = folder / "rig.toml", run = folder / "run.csv";
  ASSERT_EQ(rigtwin({"init", "--kind", "component_bench", "--driven-by", "force", "--out", rig}).status, 0);
  EXPECT_EQ(firmware::read_rig(rig).rig.kind, model::RigKind::driven_mass);
  EXPECT_EQ(rigtwin({"init", "--kind", "hil", "--driven-by", "force", "--out", folder / "hil.toml"}).status, 2);
  const Ended simulated = rigtwin({"simulate", "--rig", rig, "--duration", "4", "--out", run});
  ASSERT_EQ(simulated.status, 0) << simulated.errors;
  const Ended compared = rigtwin({"compare", "--rig", rig, "--data", run});
  EXPECT_EQ(compared.status, 0) << compared.errors;
  EXPECT_NE(compared.output.find("x_act"), std::string::npos) << compared.output;
  const Ended stability = rigtwin({"stability", "--rig", rig});
  EXPECT_EQ(stability.status, 3);
  EXPECT_NE(stability.errors.find("driven by force"), std::string::npos) << stability.errors;
  const Ended fmu = rigtwin({"fmu", "--rig", rig, "--out", folder / "rig.fmu"});
  EXPECT_EQ(fmu.status, 3);
  EXPECT_NE(fmu.errors.find("rig.toml:"), std::string::npos) << fmu.errors;
}

// What cannot be a rig is refused before anything is written; a description that somebody has is never replaced.
TEST(Init, LeavesNothingBehindAnError) {
  const TemporaryFolder folder;
  const std::string rig = folder / "rig.toml";
  EXPECT_EQ(rigtwin({"init", "--kind", "car", "--out", rig}).status, 2);
  EXPECT_EQ(rigtwin({"init", "--kind", "quarter_car", "--body-mass", "0", "--out", rig}).status, 3);
  EXPECT_EQ(rigtwin({"init", "--kind", "quarter_car", "--body-mass", "nan", "--out", rig}).status, 2);
  EXPECT_EQ(folder.count(), 0U);
  folder.write("rig.toml", "mine\n");
  EXPECT_EQ(rigtwin({"init", "--kind", "quarter_car", "--out", rig}).status, 4);
  EXPECT_EQ(TemporaryFolder::read(rig), "mine\n");
}

// Completion and manual page know every command that the help knows, and bash takes the completion.
TEST(Shell, KnowsEveryCommand) {
  const TemporaryFolder folder;
  const Ended help = rigtwin({"--help"}), completion = rigtwin({"completion"}), page = rigtwin({"manpage"});
  EXPECT_EQ(completion.status, 0);
  EXPECT_EQ(page.status, 0);
  for (const char* command : {"simulate", "compare", "stability", "frf", "diagnose", "plan", "sweep", "fmu", "init"}) {
    EXPECT_NE(help.output.find(command), std::string::npos);
    EXPECT_NE(page.output.find(".SS rigtwin " + std::string(command) + "\n"), std::string::npos) << command;
  }
  const auto script = folder.write("completion.bash", completion.output + R"(
COMP_WORDS=(rigtwin sim) COMP_CWORD=1; _rigtwin; [ "${COMPREPLY[*]}" = simulate ] || exit 1
COMP_WORDS=(rigtwin simulate --dur) COMP_CWORD=2; _rigtwin; [ "${COMPREPLY[*]}" = --duration ] || exit 1
)");
  EXPECT_EQ(std::system(("bash '" + script.string() + "'").c_str()), 0);
  EXPECT_EQ(rigtwin({"completion", "bash"}).output, completion.output);
  EXPECT_NE(page.output.find(".SH EXAMPLES\n"), std::string::npos);
  EXPECT_EQ(page.output.rfind(".TH RIGTWIN 1", 0), 0U);
}

// Each shell gets every command and option in its own language; brackets and quotes in an explanation do not end it.
TEST(Shell, CompletesInZshAndFish) {
  const Ended zsh = rigtwin({"completion", "zsh"}), fish = rigtwin({"completion", "fish"});
  ASSERT_EQ(zsh.status, 0) << zsh.errors;
  ASSERT_EQ(fish.status, 0) << fish.errors;
  EXPECT_EQ(zsh.output.rfind("#compdef rigtwin\n", 0), 0U);
  for (const char* command : {"simulate", "diagnose", "sweep"}) {
    EXPECT_NE(zsh.output.find("    '" + std::string(command) + ":"), std::string::npos) << command;
    EXPECT_NE(fish.output.find("-a " + std::string(command) + " -d '"), std::string::npos) << command;
  }
  EXPECT_NE(zsh.output.find("'--duration["), std::string::npos);
  EXPECT_NE(fish.output.find("'__fish_seen_subcommand_from simulate' -l duration -r -d '"), std::string::npos);
  EXPECT_EQ(rigtwin({"completion", "tcsh"}).status, 2);
}

// --json - is the only thing on standard output, for a run that a script reads.
TEST(Simulate, SaysTheRunAsJson) {
  const TemporaryFolder folder;
  const std::string rig = support::rig_file("paper_linear");
  const Ended run =
      rigtwin({"simulate", "--rig", rig, "--duration", "0.5", "--out", folder / "run.csv", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(run.output.rfind("{\n", 0), 0U);
  EXPECT_EQ(run.output.substr(run.output.size() - 2), "}\n");
  for (const char* key : {"\"samples\": 500", "\"trace\": \"", "\"trip\": null", "\"F_w\": {"}) {
    EXPECT_NE(run.output.find(key), std::string::npos) << key;
  }
  const Ended file = rigtwin(
      {"simulate", "--rig", rig, "--duration", "0.5", "--out", folder / "again.csv", "--json", folder / "run.json"});
  EXPECT_NE(file.output.find("trace     "), std::string::npos);
  EXPECT_EQ(TemporaryFolder::read(folder / "run.json").find("{\n"), 0U);
}

}  // namespace
