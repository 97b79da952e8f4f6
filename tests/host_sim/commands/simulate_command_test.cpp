// rigtwin simulate: a recording, what it shows, and why a run ended.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>

#include "firmware/description/text/run_stopped.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/closed_loop/trace.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using model::Channel;
using support::Ended;
using support::rig_file;
using support::rigtwin;
using support::TemporaryFolder;

// The recording is there, is what the screen says, and is a recording that rigtwin reads.
TEST(Simulate, LeavesTheRecordingItSpeaksOf) {
  const TemporaryFolder folder;
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva", "paper_linear"}) {
    const std::string out = folder / (std::string(name) + ".csv");
    const Ended ended = rigtwin({"simulate", "--rig", rig_file(name), "--duration", "1", "--out", out});
    ASSERT_EQ(ended.status, 0) << ended.errors;
    EXPECT_EQ(ended.errors, "") << name;
    EXPECT_NE(ended.output.find("1 s at 1000 Hz over iso8608:B at 27.78 m/s, seed 1"), std::string::npos);
    EXPECT_NE(ended.output.find("recording " + out + " (1000 samples)"), std::string::npos) << ended.output;
    const firmware::Recording recording = host_sim::read_recording(out, {}, 1000.0);
    EXPECT_EQ(recording.size(), 1000U);
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      if (recording.channels[i].empty()) continue;
      EXPECT_NE(ended.output.find("  " + std::string(model::channel_names[i].name) + " "), std::string::npos)
          << model::channel_names[i].name;
    }
    EXPECT_NE(TemporaryFolder::read(out).find(
                  "simulate: " +
                  std::string(name == std::string("paper_rig_fdva")
                                  ? "quarter_car"
                                  : (name == std::string("paper_bench_fdva") ? "component_bench" : "hil")) +
                  ", iso8608:B, 27.78 m/s, seed 1\n"),
              std::string::npos)
        << "the file says how it came about";
  }
}

// A run is a function of rig, road and seed: same words, same bytes; another seed or speed, another run.
TEST(Simulate, RepeatsARunToTheByte) {
  const TemporaryFolder folder;
  const auto run = [&folder](const std::vector<std::string>& more) {
    const std::string out = folder / "run.csv";
    std::vector<std::string> words{"simulate", "--rig", rig_file("paper_hil_fdva"), "--duration", "0.5", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(rigtwin(words).status, 0);
    const std::string text = TemporaryFolder::read(out);
    return text.substr(text.find("\nt,"));
  };
  const std::string first = run({});
  EXPECT_EQ(run({"--seed", "1", "--speed", "27.78", "--road", "iso8608:B", "--bandwidth", "100", "--cut-off", "0.05"}),
            first)
      << "the defaults of the contract";
  EXPECT_NE(run({"--seed", "2"}), first);
  EXPECT_NE(run({"--speed", "20"}), first);
  EXPECT_NE(run({"--road", "iso8608:A"}), first);
  EXPECT_NE(run({"--bandwidth", "50"}), first);
  EXPECT_NE(run({"--cut-off", "0.1"}), first);
  EXPECT_NE(run({"--no-noise"}), first);
}

// A MATLAB file holds the same numbers.
TEST(Simulate, WritesMatlabFiles) {
  const TemporaryFolder folder;
  const std::string csv = folder / "run.csv", mat = folder / "run.mat";
  for (const std::string& out : {csv, mat}) {
    EXPECT_EQ(rigtwin({"simulate", "--rig", rig_file("paper_bench_fdva"), "--duration", "0.2", "--out", out}).status,
              0);
  }
  const auto a = host_sim::read_recording(csv), b = host_sim::read_recording(mat);
  EXPECT_EQ(a.channels, b.channels);
  EXPECT_EQ(a.ducts, b.ducts);
}

// A road from a file is driven to its end.
TEST(Simulate, DrivesOverARoadFromAFile) {
  const TemporaryFolder folder;
  std::string text = "s [m],z_r [m]\n";
  for (int k = 0; k <= 100; ++k) text += std::to_string(k * 0.1) + "," + std::to_string(1e-4 * (k % 10)) + "\n";
  const std::string road = folder.write("road.csv", text), out = folder / "run.csv";
  const Ended ended = rigtwin(
      {"simulate", "--rig", rig_file("paper_rig_fdva"), "--road", road, "--speed", "20", "--out", out, "--no-noise"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const auto recording = host_sim::read_recording(out);
  ASSERT_EQ(recording.size(), 501U) << "10 m at 20 m/s";
  EXPECT_EQ(recording[Channel::z_r][45], 9e-4) << "0.9 m";
  EXPECT_NE(ended.output.find(road), std::string::npos);
}

// Fault. A run that the firmware stopped is no run: status 6, the reason with units on standard error, nothing else and
// no file. --allow-stop keeps the rows up to the stop.
TEST(Simulate, SaysWhyTheFirmwareStopped) {
  const TemporaryFolder folder;
  const std::string text = TemporaryFolder::read(rig_file("paper_hil_fdva"));
  const std::string rig =
      folder.write("rig.toml", support::with(text, "virtual_damping = 1140.0", "virtual_damping = 700.0"));
  const std::string out = folder / "run.csv";
  const Ended refused = rigtwin({"simulate", "--rig", rig, "--duration", "20", "--out", out, "--json", folder / "j"});
  EXPECT_EQ(refused.status, firmware::exit_status_of_stopped_run);
  EXPECT_EQ(refused.error_lines(), 1) << refused.errors;
  EXPECT_EQ(refused.errors.rfind("rigtwin: the firmware stopped the run: ", 0), 0U) << refused.errors;
  EXPECT_EQ(refused.output, "");
  EXPECT_FALSE(std::filesystem::exists(out) || std::filesystem::exists(folder / "j"));
  const Ended ended = rigtwin({"simulate", "--rig", rig, "--duration", "20", "--out", out, "--allow-stop"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
  EXPECT_EQ(ended.errors.rfind("rigtwin: the firmware stopped the run: ", 0), 0U) << ended.errors;
  EXPECT_NE(ended.errors.find(", limit "), std::string::npos) << ended.errors;
  EXPECT_LT(host_sim::read_recording(out).size(), 20000U);
}

// The trace that is printed is that of the recording in memory, to which the file reads back.
TEST(Simulate, PrintsTheTraceOfWhatItWrote) {
  const TemporaryFolder folder;
  const std::string out = folder / "run.csv";
  const Ended ended = rigtwin({"simulate", "--rig", rig_file("paper_linear"), "--duration", "0.3", "--out", out});
  const auto recording = host_sim::read_recording(out, {}, 1000.0);
  EXPECT_NE(ended.output.find("trace     " + host_sim::hexadecimal(host_sim::trace_hash(recording)) + "\n"),
            std::string::npos)
      << ended.output;
}

// Fault. Ended from outside while it writes: nothing under the final name, nothing hidden beside it, and what stood
// there before still stands.
TEST(Simulate, LeavesNothingWhenItIsTerminated) {
  const TemporaryFolder folder;
  const TemporaryFolder streams;
  const auto out = folder.write("run.csv", "what stood here");
  bool interrupted = false;
  for (int attempt = 0; attempt < 3 && !interrupted; ++attempt) {
    support::RunningProgram program(
        streams, {"simulate", "--rig", rig_file("paper_hil_fdva"), "--duration", "400", "--out", out.string()});
    while (program.running() && folder.count() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(program.id(), SIGTERM);
    interrupted = program.wait().status == -SIGTERM;
  }
  ASSERT_TRUE(interrupted) << "the program was faster than the signal, three times";
  EXPECT_EQ(folder.count(), 1U);
  EXPECT_EQ(TemporaryFolder::read(out), "what stood here");
}

}  // namespace
