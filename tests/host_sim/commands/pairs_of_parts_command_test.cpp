// Parts of a rig, two at a time in one description, through every program and command that takes one.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/pairs_of_parts.hpp"
#include "tests/support/program.hpp"

namespace pairs_of_parts_command_test {
namespace {

using support::Ended;
using support::RigOfParts;
using support::rigtwin;
using support::TemporaryFolder;

/// RIGTWIN_PAIRS: how many of the 4900 rigs are tried, and RIGTWIN_PAIRS_FROM which comes first.
int number_in(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : otherwise;
}

/// Each command ends well or says in one line what does not fit; 6, 7: the run was refused or stopped, which is said.
bool ends_well(const RigOfParts& rig, const std::string& command, const Ended& ended, bool must_run = false) {
  const bool said = ended.status == 3 || ended.status == 6 || ended.status == 7;
  EXPECT_TRUE(ended.status == 0 || (said && !must_run))
      << rig.name << ": " << command << " ended with " << ended.status << ": " << ended.errors << rig.text;
  return ended.status == 0;
}

// Law. No pair of parts ends in an internal error or a signal, whatever the command: it is computed or refused in words.
// A description that `simulate` runs is one that `fmu` takes, and `compare` its recording.
TEST(PairsOfPartsCommand, EndWellInEveryCommand) {
  const int draws = number_in("RIGTWIN_PAIRS", 6), from = number_in("RIGTWIN_PAIRS_FROM", 0);
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const std::vector<RigOfParts> rigs = support::all_rigs_of_parts(20261130);
  int driven = 0;
  for (int k = from; k < from + draws; ++k) {
    const RigOfParts& rig = rigs.at(static_cast<std::size_t>(k));
    const auto ends = [&](const std::vector<std::string>& words, bool must_run = false) {
      return ends_well(rig, words.front(), rigtwin(words), must_run);
    };
    std::ofstream(folder / "rig.toml") << rig.text;
    const bool ran =
        ends({"simulate", "--rig", at("rig.toml"), "--road", "iso8608:A", "--duration", "6", "--out", at("run.csv")});
    driven += ran ? 1 : 0;
    ends({"fmu", "--rig", at("rig.toml"), "--out", at("rig.fmu")});
    std::ofstream(folder / "proven.toml") << rig.text;
    if (rig.kind == "hil") {
      ends({"stability", "--rig", at("rig.toml"), "--json", at("stability.json")});
      ends({"stability", "--write-limits", at("proven.toml")});
    }
    const TemporaryFolder streams;
    ends_well(rig, "rig_controller",
              support::RunningProgram(streams,
                                      {"--rig", at("proven.toml"), "--simulated", "--virtual-time", "--road",
                                       "iso8608:A", "--duration", "2", "--overwrite", "--out", at("controlled.csv")},
                                      {}, RIG_CONTROLLER_PROGRAM)
                  .wait());
    if (!ran) continue;
    ends({"compare", "--rig", at("rig.toml"), "--data", at("run.csv"), "--json", at("compare.json")});
    if (rig.kind == "quarter_car") {
      ends({"estimate", "--rig", at("rig.toml"), "--data", at("run.csv"), "--out", at("states.csv")});
    }
    if (draws < 20 || k % 8 != 0) continue;  // these two take ten times as long as all others
    ends({"plan", "--rig", at("rig.toml"), "--road", "iso8608:A", "--json", at("plan.json")});
    ends({"diagnose", "--rig", at("rig.toml"), "--data", at("run.csv"), "--out", at("diagnosis")});
  }
  EXPECT_GE(4 * driven, draws);  // a quarter of what is drawn is a rig that drives; 36 % of all are
}

}  // namespace
}  // namespace pairs_of_parts_command_test
