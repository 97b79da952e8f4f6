// rig_controller --publish as a user meets it: with a simulated rig, datagrams on this machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/datagrams.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace publish_test {
namespace {

using nlohmann::json;
using support::DatagramInbox;
using support::Ended;
using support::GuardedProgram;
using support::RunningProgram;
using support::TemporaryFolder;
using testing::HasSubstr;

/// The paper's rig on a machine that may be busy: neither late periods end a run, nor the delay that they are in the loop.
std::string patient_rig(const TemporaryFolder& folder) {
  return folder.write("patient.toml", TemporaryFolder::read(support::rig_file("paper_hil_fdva")) +
                                          "\n[supervision]\ngap = 1.0\ngrowth_time = 2.0\nenergy_cycles = "
                                          "1000\n[controller]\nlate_in_a_row = 1000000\n");
}

Ended run_controller(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
  return RunningProgram(folder, arguments, {}, RIG_CONTROLLER_PROGRAM).wait();
}

/// Rows without comments, which hold times of day.
std::string data_rows(const std::filesystem::path& file) {
  std::istringstream lines(TemporaryFolder::read(file));
  std::string rows;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) rows += line + '\n';
  }
  return rows;
}

// Law. Who watches changes nothing: the recording has the same bits.
TEST(Publish, LeavesTheRunAsItIs) {
  const TemporaryFolder folder;
  const DatagramInbox inbox;
  std::vector<std::string> words{
      "--rig", support::rig_file("paper_hil_fdva"), "--simulated", "--virtual-time", "--duration", "3", "--out"};
  std::vector<std::string> watched = words;
  words.push_back(folder / "alone.csv");
  watched.insert(watched.end(), {folder / "watched.csv", "--publish", inbox.address()});
  ASSERT_EQ(run_controller(folder, words).status, 0);
  const Ended ended = run_controller(folder, watched);
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_THAT(ended.output, HasSubstr("publishing to " + inbox.address()));
  EXPECT_THAT(ended.output, HasSubstr("lost to publishing "));
  EXPECT_EQ(data_rows(folder / "watched.csv"), data_rows(folder / "alone.csv"));
}

// What comes adds up: every period of the loop was sent, or stands in `lost`, or was left out as asked.
TEST(Publish, SendsEachPeriodOrCountsIt) {
  const TemporaryFolder folder;
  const DatagramInbox inbox;
  GuardedProgram program(folder,
                         {"--rig", patient_rig(folder), "--simulated", "--no-realtime", "--duration", "1", "--publish",
                          inbox.address(), "--publish-every", "10", "--out", folder / "run.csv"},
                         {}, RIG_CONTROLLER_PROGRAM);
  std::uint64_t received = 0, lost = 0, last_period = 0;
  double last_time = -1.0;
  std::vector<std::string> states;
  std::string end;
  while (end.empty()) {
    const json object = json::parse(inbox.next(), nullptr, false);
    ASSERT_TRUE(object.is_object()) << "no datagram, or none that can be read";
    EXPECT_EQ(object["sequence"], received++);
    lost = object["lost"].get<std::uint64_t>();
    if (object.contains("ended")) {
      end = object["ended"].get<std::string>();
      break;
    }
    EXPECT_GT(object["timestamp"].get<double>(), last_time);
    last_time = object["timestamp"].get<double>();
    last_period = object["period"].get<std::uint64_t>();
    if (states.empty() || states.back() != object["state"]) states.push_back(object["state"]);
    EXPECT_EQ(object.contains("F"), true);
  }
  EXPECT_EQ(end, "reference_ended");
  EXPECT_THAT(states, testing::ElementsAre("running", "safe"));
  EXPECT_EQ(program.wait().status, 0);
  // One of ten, the change to safe, and the end.
  EXPECT_NEAR(static_cast<double>(received + lost), static_cast<double>(last_period) / 10.0 + 2.0, 1.5);
}

// The socket's state says what was published, and a decimation is no loss.
TEST(Publish, StandsInTheState) {
  const TemporaryFolder folder;
  const DatagramInbox inbox;
  GuardedProgram program(folder,
                         {"--rig", patient_rig(folder), "--simulated", "--no-realtime", "--wait", "--socket",
                          folder / "control", "--publish", inbox.address(), "--out", folder / "run.csv"},
                         {}, RIG_CONTROLLER_PROGRAM);
  ASSERT_FALSE(inbox.next().empty());
  json state;
  const TemporaryFolder streams;
  for (int i = 0; i < 100 && (!state.is_object() || state["published"] == 0); ++i) {
    state = json::parse(run_controller(streams, {"--socket", folder / "control", "state"}).output, nullptr, false);
  }
  ASSERT_TRUE(state.is_object());
  EXPECT_GT(state["published"], 0);
  EXPECT_EQ(state["publish_lost"], 0);
  ::kill(program.id(), SIGTERM);
  EXPECT_EQ(program.wait().status, 0);
}

TEST(Publish, RefusesWhatDoesNotFitInOneLine) {
  const TemporaryFolder folder;
  struct Wrong {
    std::vector<std::string> options;
    std::string says;
  };
  for (const Wrong& wrong : {Wrong{{"--publish", "10.0.0.5:9870"}, "--publish-remote"},
                             Wrong{{"--publish", "rig.example:9870"}, "expected HOST:PORT"},
                             Wrong{{"--publish", "--publish-every", "0"}, "--publish-every 0 does not fit"},
                             Wrong{{"--publish-every", "2"}, "--publish-every needs --publish"},
                             Wrong{{"--publish-remote"}, "--publish-remote needs --publish"}}) {
    std::vector<std::string> words{
        "--rig", support::rig_file("paper_hil_fdva"), "--simulated", "--virtual-time", "--out", folder / "run.csv"};
    words.insert(words.end(), wrong.options.begin(), wrong.options.end());
    const Ended ended = run_controller(folder, words);
    EXPECT_EQ(ended.status, 2) << wrong.says;
    EXPECT_THAT(ended.errors, HasSubstr(wrong.says));
    EXPECT_EQ(ended.error_lines(), 1);
    EXPECT_FALSE(std::filesystem::exists(folder / "run.csv"));
  }
}

}  // namespace
}  // namespace publish_test
