// rigtwin diagnose as a shell meets it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "firmware/description/rig_writer.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/recording_files.hpp"
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
    firmware::RigDescription description = support::rig("paper_bench_fdva");
    remove_effect(description.rig, *firmware::find_effect("coulomb_friction"), std::nullopt);
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
  support::expect_schema(TemporaryFolder::read(out / "verdict.json"));
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

// Journey. A certificate of 1 % (k = 2) makes the friction less sure, and says so in its budget; that it had
// expired when the recording was made stands behind the first sentence everywhere. Without the table the verdict is the
// same but for its keys.
TEST_F(DiagnoseCommand, CountsTheCalibrationAndReadsTheCertificate) {
  const auto verdict_of = [&](const char* name, const std::vector<std::string>& more, std::string& output) {
    std::vector<std::string> words{"--out", (folder / name).string()};
    words.insert(words.end(), more.begin(), more.end());
    const auto ended = run(words);
    EXPECT_EQ(ended.status, 0) << ended.errors;
    output = ended.output;
    const std::string text = TemporaryFolder::read(folder / name / "verdict.json");
    support::expect_schema(text);
    return nlohmann::json::parse(text);
  };
  std::string plain_output, output;
  const auto plain = verdict_of("plain", {}, plain_output);
  EXPECT_TRUE(plain["certificates"].empty());
  EXPECT_EQ(plain_output.find("calibration"), std::string::npos) << plain_output;

  const std::string description = TemporaryFolder::read(folder / "bench.toml");
  folder.write("bench.toml", description +
                                 "[calibration.F]\ngain = 0.01\ncertificate = '4711'\ndate = 2024-03-01\n"
                                 "valid_until = '2025-02-28'\n");
  const auto calibrated = verdict_of("calibrated", {"--recorded", "2026-05-04"}, output);
  const std::string objection = "the certificate 4711 of F expired on 2025-02-28, before the recording (2026-05-04)";
  ASSERT_EQ(calibrated["certificates"].size(), 1U);
  EXPECT_EQ(calibrated["certificates"][0], objection);
  EXPECT_LT(output.find("calibration: " + objection), output.find("  coulomb_friction")) << output;
  EXPECT_NE(output.find("uncertainty of force: mostly calibration of F: "), std::string::npos) << output;
  const std::string page = TemporaryFolder::read(folder / "calibrated" / "report.html");
  EXPECT_NE(page.find("Calibration: " + objection), std::string::npos);
  EXPECT_NE(page.find("Where the uncertainty comes from"), std::string::npos);

  const auto& before = plain["effects"][0]["parameters"]["force"];
  const auto& after = calibrated["effects"][0]["parameters"]["force"];
  EXPECT_EQ(before["value"], after["value"]);
  EXPECT_EQ(plain["effects"][0]["confidence"], calibrated["effects"][0]["confidence"]);
  EXPECT_EQ(plain["gap"], calibrated["gap"]);
  const auto half_of = [](const auto& number) {
    return 0.5 * (number["ci95"][1].template get<double>() - number["ci95"][0].template get<double>());
  };
  const auto& budget = after["uncertainty_budget"];
  EXPECT_EQ(budget["parts"][0]["source"], "calibration");
  EXPECT_EQ(budget["parts"][0]["of"], "F");
  // All but the friction is exact here, so it takes over what F is off elsewhere as well.
  const double standard = budget["parts"][0]["standard"];
  EXPECT_GT(standard, 0.005 * after["value"].get<double>());
  EXPECT_NEAR(half_of(after), std::hypot(half_of(before), 1.96 * standard), 0.01 * half_of(after));
  double variance = 0.0;
  for (const auto& part : budget["parts"]) variance += std::pow(part["standard"].get<double>(), 2);
  EXPECT_NEAR(variance / std::pow(budget["combined"].get<double>(), 2), 1.0, 0.02);
  const auto& predicted = calibrated["predictions"]["F"]["rms"];
  EXPECT_EQ(predicted["uncertainty_budget"]["parts"][0]["source"], "calibration");
  EXPECT_GT(predicted["ci95"][1], predicted["value"]);

  folder.write("bench.toml", description);
  const auto wrong = run({"--out", (folder / "wrong").string(), "--recorded", "4.5.2026"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.errors.find("--recorded"), std::string::npos) << wrong.errors;
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
  refused(run({"--out", (folder / "bench.toml").string()}), 4, "is not a folder");
  refused(run({}), 2, "--out");
  refused(rigtwin({"diagnose", "--explain", "top_mont"}), 2, "top_mount");
  folder.write("short.csv", "t,x_cmd,x_act,F\n0,0,0,0\n0.001,0,0,0\n0.002,0,0,0\n");
  refused(rigtwin({"diagnose", "--rig", (folder / "bench.toml").string(), "--data", (folder / "short.csv").string(),
                   "--out", (folder / "o").string()}),
          3, "at least 2.5 s");
  EXPECT_EQ(rigtwin({"diagnose", "--explain", "top_mount"}).status, 0);
}

// What cannot be judged is refused in one line that says what to do, before anything is written.
TEST_F(DiagnoseCommand, RefusesWhatCannotBeJudged) {
  using firmware::Recording;
  const auto refused = [&](const std::string& rig, const Recording& recording, const std::string& words) {
    host_sim::write_recording(folder / "wrong.csv", recording);
    const auto ended = rigtwin({"diagnose", "--rig", (folder / rig).string(), "--data", (folder / "wrong.csv").string(),
                                "--out", (folder / "refused").string()});
    EXPECT_EQ(ended.status, 3) << words;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(words), std::string::npos) << ended.errors;
    if (std::filesystem::exists(folder / "refused")) {
      EXPECT_TRUE(std::filesystem::is_empty(folder / "refused")) << words;
    }
  };
  const Recording recording = host_sim::read_recording(folder / "rec.csv");
  Recording wrong = recording;
  for (double& F : wrong[model::Channel::F]) F *= -1e-3;
  refused("bench.toml", wrong, "F looks like kilonewtons with the sign swapped");
  wrong = recording;
  for (double& x : wrong[model::Channel::x_cmd]) x *= 1e3;
  refused("bench.toml", wrong, "[channels]: x_cmd = { column = \"x_cmd\", scale = 0.001 }");
  wrong = recording;
  wrong[model::Channel::x_act].clear();
  std::fill(wrong[model::Channel::x_cmd].begin(), wrong[model::Channel::x_cmd].end(), 0.01);
  refused("bench.toml", wrong, "neither x_cmd nor x_act");
  folder.write("car.toml", format_rig(support::rig("paper_rig_fdva")));
  refused("car.toml", recording, "looks like a recording of a component_bench");
  folder.write("loose.toml",
               TemporaryFolder::read(folder / "bench.toml") + "[tolerance]\nsuspension.stiffness = 1.0\n");
  refused("loose.toml", recording, "lets suspension.stiffness be 0");
}

// A dead sensor and clipped samples cost what they hold and no more: the rest is judged, and what is missing is said.
// Files in the folder that are not ours stay.
TEST_F(DiagnoseCommand, JudgesWhatIsLeftAndSaysWhatIsNot) {
  using model::Channel;
  firmware::Recording recording = host_sim::read_recording(folder / "rec.csv");
  std::fill(recording[Channel::x_act].begin(), recording[Channel::x_act].end(), 0.0);
  const double limit = 0.8 * *std::max_element(recording[Channel::F].begin(), recording[Channel::F].end());
  for (double& F : recording[Channel::F]) F = std::clamp(F, -limit, limit);
  host_sim::write_recording(folder / "rec.csv", recording);
  firmware::RigDescription description = firmware::read_rig(folder / "bench.toml");
  description.range[index(Channel::F)] = {-limit, limit};
  folder.write("bench.toml", format_rig(description));
  const TemporaryFolder out;
  const auto notes = out.write("notes.txt", "mine");
  const auto ended = run({"--out", out.path().string()});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_EQ(out.count(), 4U) << "notes.txt and three of ours";
  EXPECT_EQ(TemporaryFolder::read(notes), "mine");
  const auto verdict = nlohmann::json::parse(TemporaryFolder::read(out / "verdict.json"));
  EXPECT_EQ(verdict["verdict"], "named");
  ASSERT_EQ(verdict["effects"].size(), 1U);
  EXPECT_EQ(verdict["effects"][0]["name"], "coulomb_friction");
  EXPECT_FALSE(verdict["gap"].contains("x_act"));
  const std::string remarks = verdict["remarks"].dump();
  EXPECT_NE(remarks.find("x_act is 0 m throughout"), std::string::npos) << remarks;
  EXPECT_NE(remarks.find("clipped samples of F"), std::string::npos) << remarks;
}

// Interrupted, a diagnosis leaves what was there before, byte for byte, and nothing of its own.
TEST_F(DiagnoseCommand, LeavesNothingHalfWrittenWhenInterrupted) {
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction present {};
    ::sigaction(signal, nullptr, &present);
    if (present.sa_handler == SIG_IGN) continue;  // a shell's background job; the program inherits it
    bool interrupted = false;
    // A program faster than the signal has ended well: the next one has more to do and gets its signal earlier.
    std::vector<std::string> data;
    for (int wait = 400; wait > 10 && !interrupted; wait /= 2) {
      for (int copy = 0; copy < 4; ++copy) data.insert(data.end(), {"--data", (folder / "rec.csv").string()});
      const TemporaryFolder out, streams;
      out.write("verdict.json", "{}\n");
      std::vector<std::string> arguments{"diagnose", "--rig", (folder / "bench.toml").string(), "--out",
                                         out.path().string()};
      arguments.insert(arguments.end(), data.begin(), data.end());
      support::RunningProgram program(streams, arguments);
      std::this_thread::sleep_for(std::chrono::milliseconds(wait));
      ::kill(program.id(), signal);
      const support::Ended ended = program.wait();
      interrupted = ended.status == -signal;
      if (!interrupted) {
        ASSERT_EQ(ended.status, 0) << ended.errors;
        continue;
      }
      EXPECT_EQ(out.count(), 1U);
      EXPECT_EQ(TemporaryFolder::read(out / "verdict.json"), "{}\n");
    }
    EXPECT_TRUE(interrupted) << "the program was faster than every signal";
  }
}

// Of a recording of 70 MB the ends alone are read; the hidden delay and the remark are those of the whole.
TEST_F(DiagnoseCommand, ReadsTheEndsOfALongRecording) {
  const std::string rig = support::rig_file("paper_hil_fdva");
  const auto made = rigtwin({"simulate", "--rig", rig, "--duration", "265", "--out", folder / "long.csv"});
  ASSERT_EQ(made.status, 0) << made.errors;
  ASSERT_GT(std::filesystem::file_size(folder / "long.csv"), firmware::long_recording);
  const std::string described =
      support::with(TemporaryFolder::read(rig), "[effects.actuator_delay]\ndelay = 0.010\n", "");
  const auto ended = rigtwin({"diagnose", "--rig", folder.write("described.toml", described), "--data",
                              folder / "long.csv", "--out", folder / "found"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_THAT(ended.output, testing::HasSubstr("The model lacks actuator_delay (0.01 s)"));
  EXPECT_THAT(ended.output, testing::HasSubstr("long.csv: of 265 s the first 120 s are fitted, the last 40 s held out, "
                                               "and nothing else is read\n"));
}

}  // namespace
