// The program as a shell meets it: exit status, one line where something is wrong, nothing half-done left behind.
#include "host_sim/commands/command_line.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using support::Ended;
using support::hil_text;
using support::rigtwin;
using support::TemporaryFolder;
using support::with;

/// The program says one line that holds `says`, ends with the status and leaves nothing under the name `never`.
void expect_refused(const std::vector<std::string>& arguments, int status, const std::string& says,
                    const std::filesystem::path& never = {}) {
  std::string line;
  for (const std::string& word : arguments) line += " " + word;
  const Ended ended = rigtwin(arguments);
  EXPECT_EQ(ended.status, status) << line << '\n' << ended.errors;
  EXPECT_EQ(ended.error_lines(), 1) << line << '\n' << ended.errors;
  EXPECT_EQ(ended.errors.rfind("rigtwin: ", 0), 0U) << ended.errors;
  EXPECT_NE(ended.errors.find(says), std::string::npos) << line << '\n' << ended.errors << "expected: " << says;
  EXPECT_EQ(ended.output, "") << line;
  EXPECT_FALSE(!never.empty() && std::filesystem::exists(never)) << line;
}

/// Everything below works on a sound rig and a sound recording, each spoilt in one way.
class CommandLine : public ::testing::Test {
 protected:
  static std::string recording_text() {
    std::string text = "t,z_r,F\n";
    for (int k = 0; k < 40; ++k) {
      text += std::to_string(k / 1000) + "." + (k < 10 ? "00" : "0") + std::to_string(k) + "," +
              (k % 4 < 2 ? "0.001" : "-0.001") + "," + std::to_string(k) + "\n";
    }
    return text;
  }

  void expect_rig_refused(const std::string& text, const std::string& says) {
    const auto bad = folder.write("bad.toml", text).string();
    const auto out = folder / "run.csv";
    expect_refused({"simulate", "--rig", bad, "--duration", "0.1", "--out", out}, 3, says, out);
    expect_refused({"compare", "--rig", bad, "--data", data, "--json", out}, 3, says, out);
  }

  void expect_recording_refused(const std::string& text, const std::string& says) {
    const auto bad = folder.write("bad.csv", text).string();
    const auto out = folder / "result.json";
    expect_refused({"compare", "--rig", rig, "--data", bad, "--json", out}, 3, says, out);
  }

  TemporaryFolder folder;
  std::string rig = folder.write("rig.toml", hil_text);
  std::string data = folder.write("rec.csv", recording_text());
};

TEST_F(CommandLine, HelpsOnRequest) {
  const Ended help = rigtwin({"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.errors, "");
  for (const char* word : {"Usage: rigtwin", "simulate", "compare", "--help"}) {
    EXPECT_NE(help.output.find(word), std::string::npos) << word;
  }
  const Ended simulate = rigtwin({"simulate", "--help"});
  for (const char* word :
       {"--rig", "--road", "--speed", "--duration", "--seed", "--out", "[m/s]", "[s]", "iso8608:B"}) {
    EXPECT_NE(simulate.output.find(word), std::string::npos) << word;
  }
  const Ended compare = rigtwin({"compare", "--help"});
  for (const char* word : {"--rig", "--data", "--json", "--refit", "--start"}) {
    EXPECT_NE(compare.output.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(compare.output.find("->"), std::string::npos) << "no numbers of an enum";
  EXPECT_EQ(rigtwin({"--version"}).output.rfind("rigtwin ", 0), 0U);
}

// Whoever types the bare name wants to know what there is.
TEST_F(CommandLine, HelpsWithoutAnOption) {
  const std::string help = rigtwin({"--help"}).output;
  for (const std::vector<std::string>& words : {std::vector<std::string>{}, {"help"}}) {
    const Ended bare = rigtwin(words);
    EXPECT_EQ(bare.status, 0);
    EXPECT_EQ(bare.output, help);
  }
  EXPECT_EQ(rigtwin({"help", "simulate"}).output, rigtwin({"simulate", "--help"}).output);
}

TEST_F(CommandLine, RefusesWrongUsage) {
  const auto out = folder / "run.csv";
  expect_refused({"help", "simulat"}, 2, "unknown command 'simulat' (did you mean 'simulate'?)");
  expect_refused({"simulat"}, 2, "unknown command 'simulat' (did you mean 'simulate'?), expected one of simulate, ");
  expect_refused({"simulate", "--out", out}, 2, "--rig");
  expect_refused({"simulate", "--rig", rig}, 2, "--out");
  expect_refused({"compare", "--rig", rig}, 2, "--data");
  const auto refuse = [&](const std::string& option, const std::string& value, const std::string& says) {
    expect_refused({"simulate", "--rig", rig, "--out", out, option, value}, 2, says, out);
  };
  refuse("--speed", "0", "--speed: is '0', expected a number from 0.1 to 150");
  refuse("--speed", "nan", "--speed: is 'nan'");
  refuse("--speed", "fast", "--speed: is 'fast'");
  refuse("--duration", "-1", "--duration: is '-1'");
  refuse("--duration", "nan", "--duration: is 'nan'");
  refuse("--duration", "inf", "--duration: is 'inf'");
  refuse("--duration", "0.0001", "--duration 1e-04 does not fit");
  refuse("--duration", "1e6", "--duration 1e+06 does not fit");
  refuse("--seed", "-1", "--seed: is '-1'");
  refuse("--seed", "1.5", "--seed: is '1.5'");
  refuse("--seed", "18446744073709551616", "--seed: is '18446744073709551616'");
  refuse("--bandwidth", "nan", "--bandwidth: is 'nan'");
  refuse("--bandwidth", "201", "--bandwidth is above a fifth of the sample rate, expected at most 200 Hz");
  refuse("--cut-off", "nan", "--cut-off: is 'nan'");
  refuse("--road", "iso8608:I", "unknown road class 'I'");
  refuse("--road", "iso8608:", "unknown road class ''");
  refuse("--speeed", "3", "--speeed");
  expect_refused({"simulate", "--rig", rig, "--out", out, "--road", data, "--cut-off", "1"}, 2, "ISO 8608", out);
  expect_refused({"compare", "--rig", rig, "--data", data, "--start", "now"}, 2,
                 "--start: is 'now', expected automatic, rest or estimated");
}

// The list of the issue, both commands: one line, status 3, no output file.
TEST_F(CommandLine, RefusesRigsThatDoNotFit) {
  expect_rig_refused(with(hil_text, "mass = 290.0", "mass = "), "bad.toml:4: TOML syntax");
  expect_rig_refused(with(hil_text, "virtual_damping", "virtual_dampin"), "bad.toml:14: unknown key");
  expect_rig_refused(with(hil_text, "mass = 290.0", "mass = -290.0"), "bad.toml:4: body.mass = -290 does not fit");
  expect_rig_refused(with(hil_text, "sample_rate = 1000.0", "sample_rate = 0"), "bad.toml:2: sample_rate = 0");
  expect_rig_refused(with(hil_text, "delay = 0.010", "delay = 0.6"), "bad.toml:26: effects.actuator_delay.delay = 0.6");
  expect_rig_refused("", "bad.toml: the file is empty");
  const auto out = folder / "run.csv";
  expect_refused({"simulate", "--rig", folder.path(), "--out", out}, 3, "is a directory", out);
  expect_refused({"simulate", "--rig", folder / "none.toml", "--out", out}, 3, "none.toml: cannot be opened", out);
  expect_refused({"simulate", "--rig", folder.write("odd.toml", with(hil_text, "1000.0", "3000.0")), "--out", out}, 3,
                 "not a whole number of nanoseconds", out);
}

TEST_F(CommandLine, RefusesRecordingsThatDoNotFit) {
  const std::string good = recording_text();
  EXPECT_EQ(rigtwin({"compare", "--rig", rig, "--data", data}).status, 0);
  expect_recording_refused(with(good, "z_r,", "z_x,"), "z_r");
  expect_recording_refused(with(good, ",F\n", ",G\n"), "nothing is measured that a hil answers with");
  // Single samples and rows are left out, with their line; of 40 rows three are too many.
  for (const char* none : {"0.007,nan", "0.007,inf"}) {
    const auto lame = folder.write("lame.csv", with(good, "0.007,-0.001", none)).string();
    EXPECT_NE(rigtwin({"compare", "--rig", rig, "--data", lame})
                  .output.find("1 row is missing or incomplete and not used, "
                               "the first at line 9"),
              std::string::npos)
        << none;
  }
  std::string lamer = good;
  for (const char* t : {"0.007,", "0.008,", "0.009,"}) lamer = with(lamer, t, std::string(t) + "nan");
  expect_recording_refused(lamer, "bad.csv:9: ");
  expect_recording_refused(with(good, "0.007,-0.001,7", "0.007,-0.001"), "bad.csv:9: ");
  expect_recording_refused(with(good, "0.007,", "0.005,"), "bad.csv:9: ");
  expect_recording_refused("", "bad.csv");
  expect_recording_refused("t,z_r,F\n", "bad.csv");
  expect_refused({"compare", "--rig", rig, "--data", folder.path()}, 3, "is a directory");
  expect_refused({"compare", "--rig", rig, "--data", folder / "none.csv"}, 3, "none.csv: cannot be opened");
  expect_refused({"compare", "--rig", rig, "--data", data, "--refit"}, 3, "nothing to refit");
}

TEST_F(CommandLine, SaysWhatItCannotWrite) {
  const auto refuse = [this](const std::string& out, const std::string& says) {
    expect_refused({"simulate", "--rig", rig, "--duration", "0.1", "--out", out}, 4, says);
    expect_refused({"compare", "--rig", rig, "--data", data, "--json", out}, 4, says);
  };
  refuse(folder / "none" / "run.csv", "cannot be created");
  refuse(folder.path(), "is a directory");
  refuse("/dev/full", "/dev/full: cannot be written");
  EXPECT_EQ(folder.count(), 2U) << "the rig and the recording, nothing hidden beside them";
}

// Results go to standard output: when that is full, whoever reads them has not got them.
TEST_F(CommandLine, SaysWhenItsResultsCannotBeShown) {
  const auto out = folder / "run.csv";
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"simulate", "--rig", rig, "--duration", "0.1", "--out", out},
           {"compare", "--rig", rig, "--data", data},
           {"compare", "--rig", rig, "--data", data, "--json", "-"},
           {"--help"},
       }) {
    const Ended ended = rigtwin(arguments, "/dev/full");
    EXPECT_EQ(ended.status, 4) << arguments.front();
    EXPECT_EQ(ended.errors, "rigtwin: standard output: cannot be written, expected room for the results\n");
  }
}

}  // namespace
