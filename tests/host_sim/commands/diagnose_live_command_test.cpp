// rigtwin diagnose --live as a user calls it: a recording in which a sensor changes, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/live/changing_rig.hpp"
#include "tests/support/program.hpp"

namespace diagnose_live_command_test {
namespace {

using model::Channel;
using nlohmann::json;
using support::Ended;
using support::rigtwin;
using testing::HasSubstr;

class DiagnoseLive : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string rig(const firmware::RigDescription& description) const {
    std::ofstream(folder_ / "rig.toml") << description.text;
    return at("rig.toml");
  }
  /// A bench whose load cell gains 10 % after 30 s.
  std::string recording() const {
    firmware::Recording r;
    r.sample_period = 1e-3;
    sample::Run run;
    run.duration = 34.0;
    run.changes_at = 30.0;
    run.change = [](model::RigParameters<double>& rig) { rig.effects.add<model::SensorGain>(Channel::F, {1.1}); };
    sample::drive(sample::component_bench(), run, [&](const host_sim::live::LiveSample& s) {
      r.time.push_back(s.time);
      for (const Channel c : {Channel::x_cmd, Channel::x_act, Channel::F}) r[c].push_back(s.values[index(c)]);
    });
    host_sim::write_recording(at("run.csv"), r);
    return at("run.csv");
  }
  void refused(const std::vector<std::string>& words, int status, const std::string& line) const {
    const Ended ended = rigtwin(words);
    EXPECT_EQ(ended.status, status) << line;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_THAT(ended.errors, HasSubstr(line));
  }
  support::TemporaryFolder folder_;
};

// Journey. The JSON agrees with its schema (rigtwin() looks).
TEST_F(DiagnoseLive, NamesASensorThatChangesInARecording) {
  const std::string description = rig(sample::component_bench()), run = recording();
  const Ended ended = rigtwin({"diagnose", "--rig", description, "--live", run, "--json", "-"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const json result = json::parse(ended.output);
  ASSERT_EQ(result["findings"].size(), 1U) << ended.output;
  EXPECT_EQ(result["findings"][0]["cause"]["name"], "sensor_gain");
  EXPECT_LE(result["findings"][0]["named_at"], 35.0);
  EXPECT_EQ(result["stage"], "learning") << "the baseline of what was named";
  EXPECT_THAT(rigtwin({"diagnose", "--rig", description, "--live", run}).output,
              HasSubstr("sensor_gain of F: gain 1.1"));
}

TEST_F(DiagnoseLive, SaysWhatIsWrongInOneLine) {
  const std::string description = rig(sample::quarter_car());
  refused({"diagnose", "--live"}, 2, "--rig is needed");
  refused({"diagnose", "--rig", description, "--live", "--out", at("out")}, 2, "takes no --data");
  refused({"diagnose", "--rig", description, "--socket", "/tmp/x", "--data", "x.csv", "--out", at("out")}, 2,
          "--socket belongs to --live");
  refused({"diagnose", "--rig", description, "--live", "127.0.0.1:99999"}, 2, "--live '127.0.0.1:99999'");
  refused({"diagnose", "--rig", description, "--live", at("none.csv")}, 3, "cannot be opened");
  refused({"diagnose", "--rig", description, "--live", recording()}, 3,
          "nothing is measured that drives the simulation");
  refused({"watch", "--diagnose", "--port", "0"}, 2, "watch --diagnose: --rig is needed");
}

}  // namespace
}  // namespace diagnose_live_command_test
