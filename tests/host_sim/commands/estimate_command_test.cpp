// rigtwin estimate as a user calls it: the paper's rig with 5 kg at its force sensor, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace estimate_command_test {
namespace {

using nlohmann::json;
using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;
using testing::HasSubstr;

std::string shipped() { return TemporaryFolder::read(support::rig_file("paper_rig_kalman")); }

class EstimateCommand : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  void simulate(const std::string& rig, const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"simulate", "--rig", rig, "--duration", "25", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = rigtwin(words);
    ASSERT_EQ(ended.status, 0) << ended.errors;
  }
  void refused(const std::vector<std::string>& words, int status, const std::string& line) const {
    const Ended ended = rigtwin(words);
    EXPECT_EQ(ended.status, status) << line;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_THAT(ended.errors, HasSubstr(line));
    EXPECT_FALSE(std::filesystem::exists(at("est.csv"))) << line;
  }
  TemporaryFolder folder_;
};

// Journey. The rig whose ducts a policy switches: its wheel load by the filter is far better than the soft sensor (10 N
// of noise and no tyre damping) and the sensor with 5 kg on it; the model is right, and the page says so. The ducts are
// read from the recording.
TEST_F(EstimateCommand, FindsTheWheelLoadOfThePapersRig) {
  const std::string rig = file("rig.toml", shipped());
  const std::string right =
      file("right.toml", support::with(shipped(), "[effects.force_sensor_inertia]\nmass = 5.0\n", ""));
  simulate(rig, at("drive.csv"), {"--seed", "31"});
  simulate(right, at("noisy_truth.csv"), {"--seed", "31"});
  // The truth drives the same ducts: a plan by hand would be another run. The noisy run without the mass has other
  // estimates and so other ducts; hence the comparison on a rig whose ducts are planned.
  const std::string planned =
      file("planned.toml", support::with(shipped(), "policy = \"rollout\"", "plan = [{ t = 3.0, open = 4 }]"));
  const std::string truth = file(
      "truth.toml", support::with(TemporaryFolder::read(planned), "[effects.force_sensor_inertia]\nmass = 5.0\n", ""));
  simulate(planned, at("planned.csv"), {"--seed", "31"});
  simulate(truth, at("truth.csv"), {"--seed", "31", "--no-noise"});
  const Ended ended = rigtwin({"estimate", "--rig", planned, "--data", at("planned.csv"), "--truth", at("truth.csv"),
                               "--out", at("est.csv"), "--report", at("page.html"), "--json", at("est.json")});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_THAT(ended.output, HasSubstr("do not contradict the model"));
  const json found = json::parse(TemporaryFolder::read(at("est.json")));
  const auto error = [&found](const char* source) { return found["wheel_load"][source]["error_rms"].get<double>(); };
  EXPECT_LT(error("filter"), 2.5);
  EXPECT_GT(error("k_t dz_w"), 9.5);
  EXPECT_GT(error("sensor F_w"), 50.0);
  EXPECT_NEAR(found["nis"].get<double>(), 1.0, 0.02);
  EXPECT_THAT(TemporaryFolder::read(at("page.html")), HasSubstr("Error of the wheel load"));
  // The run with the policy: many switchings are on record, and the filter follows them.
  const Ended policy = rigtwin({"estimate", "--rig", rig, "--data", at("drive.csv"), "--out", at("policy.csv")});
  EXPECT_EQ(policy.status, 0) << policy.errors;
  EXPECT_THAT(policy.output, HasSubstr("do not contradict the model"));
}

// Law. Without stamps a sample is as old as [estimator] age says: dz_b written down five rows late costs no more than
// the filter expects of such a rig; taken as new it costs many times that, and the monitor says that something is
// wrong.
TEST_F(EstimateCommand, TakesTheDescribedAgeWhereThereAreNoStamps) {
  const std::string planned = support::with(shipped(), "policy = \"rollout\"", "plan = [{ t = 3.0, open = 4 }]");
  const std::string rig = file("planned.toml", planned);
  simulate(rig, at("drive.csv"), {"--seed", "33"});
  std::istringstream rows(TemporaryFolder::read(at("drive.csv")));
  std::string late;
  std::size_t column = 0;
  std::deque<std::string> past;
  for (std::string line; std::getline(rows, line);) {
    if (line.starts_with("#")) continue;
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (column == 0) {
      while (!cells[column].starts_with("dz_b")) ++column;
    } else {
      past.push_back(cells[column]);
      if (past.size() > 6) past.pop_front();
      cells[column] = past.front();
    }
    for (std::size_t i = 0; i < cells.size(); ++i) late += (i > 0 ? "," : "") + cells[i];
    late += '\n';
  }
  const std::string sensors = "kind = \"kalman\"\nsensors = [\"dz_b\", \"zdd_b\", \"zdd_w\"]";
  const auto estimate = [&](const std::string& more) {
    const std::string used = file("used.toml", support::with(planned, "kind = \"kalman\"", sensors + more));
    const Ended ended = rigtwin({"estimate", "--rig", used, "--data", file("late.csv", late), "--out", at("est.csv"),
                                 "--json", at("est.json")});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    return json::parse(TemporaryFolder::read(at("est.json")))["nis"].get<double>();
  };
  EXPECT_NEAR(estimate("\nage = { dz_b = 0.005 }"), 1.0, 0.05);
  EXPECT_GT(estimate(""), 2.0);
}

// Fault. A truth in which a policy opened other ducts is another run.
TEST_F(EstimateCommand, RefusesATruthWithOtherDucts) {
  const std::string rig = file("rig.toml", shipped());
  simulate(rig, at("drive.csv"));
  simulate(rig, at("truth.csv"), {"--no-noise"});
  refused({"estimate", "--rig", rig, "--data", at("drive.csv"), "--truth", at("truth.csv"), "--out", at("est.csv")}, 3,
          "of the truth is not that of the recording");
}

// Law. An estimate is no recording: diagnose finds no channel in it.
TEST_F(EstimateCommand, LeavesNothingThatDiagnoseWouldTake) {
  const std::string rig = file("rig.toml", shipped());
  simulate(rig, at("drive.csv"));
  ASSERT_EQ(rigtwin({"estimate", "--rig", rig, "--data", at("drive.csv"), "--out", at("states.csv")}).status, 0);
  EXPECT_EQ(rigtwin({"diagnose", "--rig", rig, "--data", at("states.csv"), "--out", at("diagnosis")}).status, 3);
}

// Journey. diagnose copes with ducts that a policy switched: the openings are on record, and nothing is missing.
TEST_F(EstimateCommand, PolicySwitchingIsOnRecordForDiagnose) {
  const std::string rig =
      file("rig.toml", support::with(shipped(), "policy = \"rollout\"", "policy = \"rollout\"\ndelay = 0.02"));
  // Class A: on class B the cylinder's speed limit is reached six times, and such a kink is no motion between samples.
  simulate(rig, at("drive.csv"), {"--seed", "32", "--road", "iso8608:A"});
  const Ended ended = rigtwin({"diagnose", "--rig", rig, "--data", at("drive.csv"), "--out", at("diagnosis")});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const json verdict = json::parse(TemporaryFolder::read(at("diagnosis") + "/verdict.json"));
  EXPECT_EQ(verdict["verdict"], "no_discrepancy");
}

// What does the first sentence say? Of a recording that is too short for the monitor of the innovations that nothing
// was judged: no tick, null.
TEST_F(EstimateCommand, SaysWhatItDidNotJudge) {
  const std::string rig = file("rig.toml", shipped());
  ASSERT_EQ(rigtwin({"simulate", "--rig", rig, "--duration", "5", "--out", at("short.csv")}).status, 0);
  const Ended ended = rigtwin({"estimate", "--rig", rig, "--data", at("short.csv"), "--out", at("est.csv"), "--report",
                               at("page.html"), "--json", at("est.json")});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_TRUE(json::parse(TemporaryFolder::read(at("est.json")))["model_wrong"].is_null());
  EXPECT_THAT(ended.output, HasSubstr("The model was not judged: the monitor of the innovations needs 20480 samples"));
  const std::string page = TemporaryFolder::read(at("page.html"));
  EXPECT_THAT(page, HasSubstr("class=\"verdict remark\""));
  EXPECT_EQ(page.find("class=\"verdict good\""), std::string::npos);
}

// Fault. One line each, nothing written.
TEST_F(EstimateCommand, RefusesWhatCannotBeEstimated) {
  const std::string rig = file("rig.toml", shipped());
  simulate(rig, at("drive.csv"));
  const auto with = [&](const std::string& name, const std::string& to) {
    return std::vector<std::string>{
        "estimate",
        "--rig",
        file(name, support::with(shipped(), "kind = \"kalman\"", "kind = \"kalman\"\n" + to)),
        "--data",
        at("drive.csv"),
        "--out",
        at("est.csv")};
  };
  refused(with("a.toml", "sensors = [\"zdd_b\", \"zdd_w\"]\ncut_off = 0.0"), 3,
          "'z_w' is not observable with zdd_w, zdd_b");
  refused(with("b.toml", "sensors = [\"z_w\"]"), 3, "z_w");
  refused(with("c.toml", "sensors = [\"zdd_q\"]"), 3, "estimator.sensors");
  refused(with("d.toml", "false_alarms = nan"), 3, "false_alarms");
  refused(with("e.toml", "history = 9"), 3, "history");
  refused({"estimate", "--rig", rig, "--data", file("empty.csv", ""), "--out", at("est.csv")}, 3, "empty.csv");
  refused({"estimate", "--rig", rig, "--data", at("drive.csv"), "--out", "/dev/full"}, 4, "/dev/full");
  refused({"estimate", "--rig", rig, "--out", at("est.csv")}, 2, "--data");
  const std::string hil =
      file("hil.toml", support::with(TemporaryFolder::read(support::rig_file("paper_hil_fdva")), "kind = \"hil\"",
                                     "kind = \"hil\"\nestimator.kind = \"kalman\""));
  refused({"estimate", "--rig", hil, "--data", at("drive.csv"), "--out", at("est.csv")}, 3, "estimator.kind");
}

}  // namespace
}  // namespace estimate_command_test
