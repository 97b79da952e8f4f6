// The program rig_controller as a shell on the board meets it, with the simulated back-end. On a real-time kernel with
// lines and converters: tests/guest.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "firmware/description/text/sha256.hpp"
#include "firmware/loop/common/mode.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using support::Ended;
using support::rig_file;
using support::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

struct Controller {
  TemporaryFolder streams;
  support::RunningProgram program;
  explicit Controller(const std::vector<std::string>& arguments, const char* path = RIG_CONTROLLER_PROGRAM)
      : program(streams, arguments, {}, path) {}
  /// Waits until the program has said this.
  bool says(const std::string& words) {
    for (int i = 0; i < 10000 && program.running(); ++i) {
      if (TemporaryFolder::read(streams / "stdout.txt").find(words) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
};

/// Header and rows of a recording, without its comments.
std::string rows_of(const std::string& text) {
  std::string rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) rows += line + '\n';
  }
  return rows;
}

Ended controller(const std::vector<std::string>& arguments) { return Controller(arguments).program.wait(); }

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of('\n');
  if (end == std::string::npos) return {};
  const auto begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1,
                     end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

// Law. It is the very firmware of `rigtwin simulate`: the same rig, road and seed give the same recording to the last
// bit, every kind of rig, and the reader of compare and diagnose takes the file as it is.
TEST(RigController, RecordsTheBitsOfTheSimulation) {
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva", "paper_hil_aas"}) {
    const TemporaryFolder folder;
    const std::string out = (folder / "run.csv").string();
    const Ended ended = controller(
        {"--rig", rig_file(name), "--simulated", "--virtual-time", "--duration", "12", "--seed", "5", "--out", out});
    ASSERT_EQ(ended.status, 0) << ended.errors;
    const firmware::Recording recording = host_sim::read_recording(out, {}, 1000.0);

    const firmware::RigDescription rig = support::rig(name);
    firmware::IsoRoad road;
    road.seed = 5;
    road.bandwidth = firmware::default_bandwidth(rig.rig.kind, 1000.0);
    const auto motion = firmware::excitation(rig.rig, firmware::drive_over(road, 1000.0, 12000), 1000.0);
    host_sim::RunOptions options;
    options.seed = 5;
    const host_sim::Run run = host_sim::run_closed_loop(rig, motion, options);
    EXPECT_EQ(recording.time, run.recording.time);
    EXPECT_EQ(recording.channels, run.recording.channels) << name;
    EXPECT_EQ(recording.ducts, run.recording.ducts) << name;
    EXPECT_THAT(recording.ignored_columns, testing::Contains("age [s]"));
    EXPECT_EQ(recording.ignored_columns.back(),
              rig.rig.kind == model::RigKind::quarter_car ? "age_F_w [s]" : "age_F [s]");
    EXPECT_NE(last_line(ended.output).find("ended by reference_ended; valves safe, command at rest, 1"),
              std::string::npos)
        << last_line(ended.output);
  }
}

// Journey. The skyhook of an active air spring has its output in real time too; a busy machine is not what is tested.
TEST(RigController, DrivesAnActiveAirSpringInRealTime) {
  const TemporaryFolder folder;
  const std::string rig = folder.write("rig.toml", TemporaryFolder::read(rig_file("paper_hil_aas")) +
                                                       "\n[controller]\nlate_in_a_row = 1000000\n[supervision]\n"
                                                       "gap = 1.0\n");
  const Ended ended = controller(
      {"--rig", rig, "--simulated", "--no-realtime", "--duration", "1", "--out", (folder / "run.csv").string()});
  EXPECT_EQ(ended.status, 0) << ended.errors;
  EXPECT_THAT(ended.output, HasSubstr("ended by reference_ended"));
}

// Journey. A compensation runs on the simulated rig as in the simulation, to the bit, with what it adds on record;
// without a proof of the compensated loop nothing moves, and the message says how to get one. A change of its numbers
// takes the proof away.
TEST(RigController, WantsACompensationProven) {
  const TemporaryFolder folder;
  const std::string undamped = support::with(TemporaryFolder::read(rig_file("paper_hil_fdva")),
                                             "virtual_damping = 1140.0", "virtual_damping = 0.0");
  const std::string rig =
      folder.write("rig.toml", undamped + "\n[compensation]\nkind = \"adaptive_time_series\"\n").string();
  const std::string out = (folder / "run.csv").string(), simulated = (folder / "simulated.csv").string();
  const std::vector<std::string> drive{"--rig",  rig,         "--simulated", "--virtual-time",
                                       "--road", "iso8608:A", "--duration",  "6",
                                       "--seed", "5",         "--out",       out};
  const Ended refused = controller(drive);
  EXPECT_EQ(refused.status, 3) << refused.errors;
  EXPECT_THAT(refused.errors, AllOf(HasSubstr("nothing says that this loop is stable with its compensation"),
                                    HasSubstr("rigtwin stability --write-limits")));
  EXPECT_FALSE(std::filesystem::exists(out));

  ASSERT_EQ(support::rigtwin({"stability", "--write-limits", rig}).status, 0);
  const Ended ended = controller(drive);
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_THAT(ended.output, HasSubstr("ended by reference_ended"));
  ASSERT_EQ(support::rigtwin(
                {"simulate", "--rig", rig, "--road", "iso8608:A", "--duration", "6", "--seed", "5", "--out", simulated})
                .status,
            0);
  const firmware::Recording first = host_sim::read_recording(simulated, {}, 1000.0);
  const firmware::Recording second = host_sim::read_recording(out, {}, 1000.0);
  EXPECT_EQ(second.channels, first.channels);
  EXPECT_THAT(second.ignored_columns, testing::Contains("x_added [m]"));
  EXPECT_THAT(second.ignored_columns, testing::Contains("F_added [N]"));

  const std::string proven = TemporaryFolder::read(rig);
  folder.write("rig.toml", support::with(proven, "kind = \"adaptive_time_series\"",
                                         "kind = \"adaptive_time_series\"\nmemory = 2.0"));
  const Ended changed = controller(drive);
  EXPECT_EQ(changed.status, 3);
  EXPECT_THAT(changed.errors, HasSubstr("the loop has changed since it was found stable"));
}

// Law. A recording's sensors, played to the program again on the road of that run, give that recording again, to the
// last bit, whoever wrote it: the simulation on a PC or rig_controller itself.
TEST(RigController, ReplaysARecordingToTheBit) {
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva"}) {
    const TemporaryFolder folder;
    const std::string simulated = folder / "simulated.csv", replayed = folder / "replayed.csv";
    ASSERT_EQ(
        support::rigtwin({"simulate", "--rig", rig_file(name), "--duration", "4", "--seed", "5", "--out", simulated})
            .status,
        0);
    const Ended ended = controller({"--rig", rig_file(name), "--replay", simulated, "--seed", "5", "--out", replayed});
    ASSERT_EQ(ended.status, 0) << ended.errors;
    EXPECT_NE(last_line(ended.output).find("ended by reference_ended"), std::string::npos) << last_line(ended.output);
    const firmware::Recording first = host_sim::read_recording(simulated, {}, 1000.0);
    const firmware::Recording second = host_sim::read_recording(replayed, {}, 1000.0);
    EXPECT_EQ(second.time, first.time);
    EXPECT_EQ(second.channels, first.channels) << name;
    EXPECT_EQ(second.ducts, first.ducts) << name;

    const std::string again = folder / "again.csv";
    ASSERT_EQ(controller({"--rig", rig_file(name), "--replay", replayed, "--seed", "5", "--out", again}).status, 0);
    EXPECT_EQ(rows_of(TemporaryFolder::read(again)), rows_of(TemporaryFolder::read(replayed))) << name;
  }
}

/// A recording by hand, replayed: what the program says of it and what it records.
struct Replayed {
  Ended ended;
  std::string recording;
  explicit Replayed(const std::string& rows) {
    const TemporaryFolder folder;
    const std::string file = folder.write("run.csv", "# rigtwin recording: SI units\n" + rows);
    const std::string out = folder / "again.csv";
    ended = controller({"--rig", rig_file("paper_bench_fdva"), "--replay", file, "--out", out});
    recording = TemporaryFolder::read(out);
  }
};

// A late period is late again, and a sample that did not come is missing again: the program counts the same.
TEST(RigController, ReplaysWhatWentWrong) {
  const Replayed run(
      "t,x_act [m],F [N],late [s],age [s]\n0,0,0,0,0\n0.001,0,0,0.0001,0\n0.002,nan,0,0,0\n0.0054,0,0,0.0024,0\n"
      "0.0064,0,0,0,0\n0.0074,0,0,0,0\n");
  EXPECT_EQ(run.ended.status, 0) << run.ended.errors;
  EXPECT_THAT(run.ended.output, HasSubstr("late periods 1, bridged samples 1, missed frames 0,"));
  EXPECT_THAT(run.recording, AllOf(HasSubstr("\n0.0054,"), HasSubstr("\n0.002,"), HasSubstr(",nan,")));
}

// A sample that was as old as it may not be is as old again, also beside younger ones: with six periods F is bridged.
TEST(RigController, ReplaysWhatWasStale) {
  const Replayed run(
      "t,x_act [m],F [N],late [s],age [s],age_x_act [s],age_F [s]\n0,0,0,0,0.0049,0.00025,0.0049\n"
      "0.001,0,0,0,0.006,0,0.006\n0.002,0,0,0,0,0,0\n0.003,0,0,0,0.001,nan,0.001\n0.004,0,nan,0,0.001,0,0.001\n");
  EXPECT_EQ(run.ended.status, 0) << run.ended.errors;
  // F that is stale, x_act that is missing, F that is not finite.
  EXPECT_THAT(run.ended.output, HasSubstr("bridged samples 3, missed frames 0,"));
  EXPECT_THAT(run.recording, AllOf(HasSubstr(",0,0.0049,0.00025,0.0049\n"), HasSubstr(",0,0.006,0,0.006\n"),
                                   HasSubstr(",nan,0,1,1,0,0,0,0,4,0,1,1,0,0.001,nan,0.001\n"),
                                   HasSubstr(",nan,0,0,0,0,0,0,4,1,1,1,0,0.001,0,0.001\n")));
}

// Roads come by the code of `rigtwin simulate`: from a file as well, and shaped as wished.
TEST(RigController, DrivesOverTheRoadsOfTheSimulation) {
  const TemporaryFolder folder;
  std::string bump = "s [m],z_r [m]\n";
  for (int i = 0; i < 200; ++i) {
    bump +=
        std::to_string(0.1 * i) + "," + (i < 50 || i >= 60 ? "0" : std::to_string(0.001 * (i - 50) * (60 - i))) + "\n";
  }
  const std::string file = folder.write("bump.csv", bump);
  for (const std::vector<std::string>& road :
       {std::vector<std::string>{"--road", file, "--speed", "5"},
        std::vector<std::string>{"--road", "iso8608:A", "--bandwidth", "20", "--cut-off", "0.5", "--duration", "3"}}) {
    std::vector<std::string> simulate{"simulate", "--rig", rig_file("paper_rig_fdva"), "--out", folder / "a.csv"};
    std::vector<std::string> drive{
        "--rig", rig_file("paper_rig_fdva"), "--simulated", "--virtual-time", "--overwrite", "--out", folder / "b.csv"};
    simulate.insert(simulate.end(), road.begin(), road.end());
    drive.insert(drive.end(), road.begin(), road.end());
    ASSERT_EQ(support::rigtwin(simulate).status, 0);
    const Ended ended = controller(drive);
    ASSERT_EQ(ended.status, 0) << ended.errors;
    const firmware::Recording a = host_sim::read_recording(folder / "a.csv", {}, 1000.0);
    EXPECT_GT(a.size(), 2000U);
    EXPECT_EQ(host_sim::read_recording(folder / "b.csv", {}, 1000.0).channels, a.channels);
  }
}

// Fault. A trap in the loop's thread (which a signal from outside reaches) or in the one that writes the recording:
// valves safe, command back to rest, then the end that the trap would have been. However busy the machine is: late
// periods do not end this run, and the way back of some millimetres has 8.5 s.
TEST(RigController, MovesTheCommandToRestAfterATrap) {
  for (const bool in_the_loop : {true, false}) {
    const TemporaryFolder folder;
    const std::string out = folder / "run.csv";
    const std::string rig = folder.write(
        "slow.toml", support::with(support::quarter_car_text, "sample_rate = 1000.0", "sample_rate = 100.0") +
                         "[controller]\nlate_in_a_row = 1000\n[supervision]\ngap = 1.0\n");
    Controller running(
        {"--rig", rig, "--simulated", "--no-realtime", "--duration", "600", "--road", "iso8608:A", "--out", out});
    ASSERT_TRUE(running.says("running: "));
    const auto rows = [&] {
      const std::string text = TemporaryFolder::read(out);
      return std::count(text.begin(), text.end(), '\n');
    };
    for (int i = 0; i < 2000 && rows() < 50; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const pid_t id = running.program.id();
    pid_t target = id;
    for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(id) + "/task")) {
      const pid_t thread = std::stoi(task.path().filename().string());
      if (!in_the_loop && thread != id) target = thread;
    }
    ASSERT_EQ(target == id, in_the_loop);
    ASSERT_EQ(::syscall(SYS_tgkill, id, target, in_the_loop ? SIGSEGV : SIGABRT), 0);
    const Ended ended = running.program.wait();
    EXPECT_EQ(ended.status, in_the_loop ? -SIGSEGV : -SIGABRT);
    EXPECT_NE(ended.errors.find("ended by a trap of the program; valves safe, command at rest, from "),
              std::string::npos)
        << ended.errors;
    EXPECT_EQ(TemporaryFolder::read(out).back(), '\n') << "whole rows";
  }
}

// In the time of the machine: late or not, it counts what it did, and says that it was not real time.
TEST(RigController, RunsInTheTimeOfTheMachine) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run.csv").string();
  const std::string rig = folder.write(
      "slow.toml", support::with(support::quarter_car_text, "sample_rate = 1000.0", "sample_rate = 100.0") +
                       "[controller]\nlate_in_a_row = 1000\nallowed_delay = 1e-6\n[supervision]\ngap = 1.0\n");
  Controller running({"--rig", rig, "--simulated", "--no-realtime", "--duration", "600", "--out", out});
  ASSERT_TRUE(running.says("running: "));
  const auto rows = [&] {
    const std::string text = TemporaryFolder::read(out);
    return std::count(text.begin(), text.end(), '\n');
  };
  for (int i = 0; i < 2000 && rows() < 50; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(running.program.id(), SIGUSR1);
  ASSERT_TRUE(running.says("wake-up latency")) << "histograms on request, the run goes on";
  ::kill(running.program.id(), SIGTERM);
  const Ended ended = running.program.wait();
  EXPECT_EQ(ended.status, 0) << ended.errors;
  EXPECT_NE(last_line(ended.output).find("ended by a signal to stop; valves safe, command at rest"), std::string::npos)
      << last_line(ended.output);
  EXPECT_NE(ended.output.find("NOTE: samples and computation take"), std::string::npos);
  const std::string text = TemporaryFolder::read(out);
  EXPECT_NE(text.find("# NOT REAL TIME"), std::string::npos);
  EXPECT_GE(rows(), 50);
}

/// A rig description that a busy machine does not end by late periods.
std::string patient_rig(const TemporaryFolder& folder, const char* rate = "100.0") {
  return folder.write("patient.toml", support::with(support::quarter_car_text, "sample_rate = 1000.0",
                                                    std::string("sample_rate = ") + rate) +
                                          "[controller]\nlate_in_a_row = 1000000\n[supervision]\ngap = 1.0\n");
}

/// A pipe with a name in place of a disk. Nobody reads it, so it stalls the writer after 64 KiB.
struct StalledDisk {
  std::string name;
  int end;
  explicit StalledDisk(const TemporaryFolder& folder) : name(folder / "run.csv"), end(-1) {
    if (::mkfifo(name.c_str(), 0600) == 0) end = ::open(name.c_str(), O_RDWR | O_CLOEXEC);
  }
  StalledDisk(const StalledDisk&) = delete;
  StalledDisk& operator=(const StalledDisk&) = delete;
  ~StalledDisk() { ::close(end); }

  [[nodiscard]] int bytes() const {
    int bytes = 0;
    return ::ioctl(end, FIONREAD, &bytes) == 0 ? bytes : 0;
  }
  /// Until nothing more has gone in for a second, in which a run at 1 kHz writes 150 kB; a busy machine may stall a
  /// writer for a moment.
  void wait_until_full() const {
    for (int before = -1, same = 0, i = 0; i < 1000 && same < 10; ++i) {
      const int now = bytes();
      same = now >= 16'384 && now == before ? same + 1 : 0;
      before = now;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
};

/// The socket on which systemd listens for signs of life.
struct Systemd {
  int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  explicit Systemd(const TemporaryFolder& folder) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = folder / "notify";
    std::copy(path.begin(), path.end(), address.sun_path);
    EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  Systemd(const Systemd&) = delete;
  Systemd& operator=(const Systemd&) = delete;
  ~Systemd() {
    ::unsetenv("NOTIFY_SOCKET");
    ::close(socket);
  }
  /// The next message; empty: none is there.
  [[nodiscard]] std::string next() const {
    char text[256];
    const ssize_t size = ::recv(socket, text, sizeof text, MSG_DONTWAIT);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : std::string();
  }
  void forget() const {
    while (!next().empty()) {
    }
  }
  /// Waits for a message with these words.
  [[nodiscard]] bool hears(const std::string& words) const {
    for (int i = 0; i < 1000; ++i) {
      for (std::string message = next(); !message.empty(); message = next()) {
        if (message.find(words) != std::string::npos) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
};

// Fault. The disk stalls: the thread that waits for it is not the one that tells systemd that the program lives, nor
// the one that takes signals. SIGTERM ends the run, and the status says that the recording is not whole.
TEST(RigController, AStalledDiskHoldsUpNeitherSignalsNorTheWatchdog) {
  const TemporaryFolder folder;
  const StalledDisk disk(folder);
  const Systemd systemd(folder);
  Controller running({"--rig", patient_rig(folder, "1000.0"), "--simulated", "--no-realtime", "--duration", "600",
                      "--out", disk.name});
  ASSERT_TRUE(running.says("running: "));
  disk.wait_until_full();
  systemd.forget();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(systemd.hears("WATCHDOG=1"));
    systemd.forget();
  }
  ::kill(running.program.id(), SIGTERM);
  EXPECT_TRUE(systemd.hears("EXTEND_TIMEOUT_USEC=")) << "the return to rest takes its time";
  const Ended ended = running.program.wait();
  EXPECT_EQ(ended.status, 4) << ended.errors;
  EXPECT_THAT(last_line(ended.output), HasSubstr("ended by the disk stalls: the end of the recording is not written; "
                                                 "valves safe, command at rest"));
}

// Fault. Records are lost when the disk stalls for longer than the journal lasts (8192 records): that ends the run, and
// the status is not 0.
TEST(RigController, LostRecordsEndTheRun) {
  const TemporaryFolder folder;
  const StalledDisk disk(folder);
  Controller running({"--rig", patient_rig(folder, "4000.0"), "--simulated", "--no-realtime", "--duration", "600",
                      "--out", disk.name});
  const Ended ended = running.program.wait();
  EXPECT_EQ(ended.status, 4) << ended.errors;
  EXPECT_THAT(last_line(ended.output),
              AllOf(HasSubstr(" lost records: the disk is too slow; valves safe, command at rest")));
}

/// Until this holds, for a minute at most: a machine may be busy.
template <class Condition>
bool comes(const Condition& condition) {
  for (int i = 0; i < 6000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Until a run has written rows: a signal before power is on ends it where it stands.
void wait_until_it_moves(const std::string& recording) {
  EXPECT_TRUE(comes([&] {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(recording, none);
    return !none && bytes > 20'000;
  }));
}

// Every signal that can be caught ends a run in good order.
TEST(RigController, EverySignalEndsARunInGoodOrder) {
  const TemporaryFolder folder;
  const std::string rig = patient_rig(folder, "1000.0");
  for (const int signal :
       {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGUSR2, SIGXCPU, SIGALRM, SIGVTALRM, SIGPROF, SIGPWR, SIGRTMIN}) {
    const std::string recording = folder / (std::to_string(signal) + ".csv");
    Controller running({"--rig", rig, "--simulated", "--no-realtime", "--duration", "600", "--out", recording});
    ASSERT_TRUE(running.says("running: "));
    wait_until_it_moves(recording);
    ::kill(running.program.id(), signal);
    const Ended ended = running.program.wait();
    EXPECT_EQ(ended.status, 0) << signal;
    EXPECT_THAT(last_line(ended.output), HasSubstr("ended by a signal to stop; valves safe, command at rest"))
        << signal;
  }
}

// Signals of a terminal that goes away or is left do not end a run: neither a reader of standard output that ends, nor
// Ctrl-Z.
TEST(RigController, IsNotEndedByItsReaders) {
  const TemporaryFolder folder;
  const std::string program = std::string(RIG_CONTROLLER_PROGRAM) + " --rig " + patient_rig(folder) +
                              " --simulated --no-realtime --duration 600 --out " + (folder / "run.csv").string();
  // The shell becomes the program; the only reader of its output ends at once.
  Controller running({"-c", "exec " + program + " > >(exec true)"}, "/bin/bash");
  const auto size = [&] {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(folder / "run.csv", none);
    return none ? std::uintmax_t{0} : bytes;
  };
  ASSERT_TRUE(comes([&] { return size() >= 10'000; }));
  for (const int signal : {SIGUSR1, SIGPIPE, SIGTSTP, SIGTTOU, SIGTTIN}) ::kill(running.program.id(), signal);
  const auto before = size();
  EXPECT_TRUE(comes([&] { return size() >= before + 10'000; })) << "the run goes on";
  ::kill(running.program.id(), SIGTERM);
  EXPECT_EQ(running.program.wait().status, 0);
}

// systemd's watchdog aborts a program that hangs. The return to rest tells it how long that takes and that the program
// is alive, and further aborts wait for its end.
TEST(RigController, AnAbortWaitsForTheReturnToRest) {
  const TemporaryFolder folder;
  const Systemd systemd(folder);
  // A road that leads 50 mm away: the way back at 0.05 m/s takes 1.5 s.
  std::string road = "t [s],z_r [m]\n";
  for (int k = 0; k < 6001; ++k) {
    const double t = 0.01 * k, s = std::min(1.0, t / 2.0);
    road += std::to_string(t) + "," + std::to_string(0.05 * s * s * (3.0 - 2.0 * s)) + "\n";
  }
  Controller running({"--rig", patient_rig(folder), "--simulated", "--no-realtime", "--road",
                      folder.write("hill.csv", road), "--out", folder / "run.csv"});
  ASSERT_TRUE(running.says("running: "));
  ASSERT_TRUE(comes([&] {
    const std::string text = TemporaryFolder::read(folder / "run.csv");
    return std::count(text.begin(), text.end(), '\n') > 350;  // 2 s of the road, behind the comments
  }));
  systemd.forget();
  ::kill(running.program.id(), SIGABRT);
  EXPECT_TRUE(systemd.hears("EXTEND_TIMEOUT_USEC=10500000")) << "8.5 s and a margin of 2 s";
  ::kill(running.program.id(), SIGABRT);
  EXPECT_TRUE(systemd.hears("WATCHDOG=1"));
  ::kill(running.program.id(), SIGABRT);
  EXPECT_TRUE(systemd.hears("WATCHDOG=1"));
  const Ended ended = running.program.wait();
  EXPECT_EQ(ended.status, -SIGABRT);
  EXPECT_THAT(ended.errors, HasSubstr("valves safe, command at rest, from 50000 um"));
}

/// Column of a recording, by its name in the header.
std::vector<double> column(const std::string& file, const std::string& name) {
  std::istringstream lines(rows_of(TemporaryFolder::read(file)));
  std::string line;
  std::getline(lines, line);
  std::istringstream names(line);
  int wanted = -1, at = 0;
  for (std::string heading; std::getline(names, heading, ','); ++at) {
    if (heading == name) wanted = at;
  }
  std::vector<double> values;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string field;
    for (int i = 0; i <= wanted; ++i) std::getline(fields, field, ',');
    values.push_back(std::strtod(field.c_str(), nullptr));
  }
  return values;
}

/// Of a recording that is being written: without a row that may be torn. 1.0 as long as there is none.
std::vector<double> whole_rows(const std::string& file, const std::string& name) {
  std::vector<double> values = column(file, name);
  if (!values.empty()) values.pop_back();
  if (values.empty()) values.push_back(1.0);
  return values;
}

std::string hill(const TemporaryFolder& folder) {
  std::string road = "t [s],z_r [m]\n";
  for (int k = 0; k < 1001; ++k) road += std::to_string(0.01 * k) + "," + std::to_string(0.01 + 1e-5 * k) + "\n";
  return folder.write("hill.csv", road);
}

// The way to the run and back is on record as well, with the state of each row; the file says why and when the run
// ended and by which description. Analyses read the run alone, from t = 0.
TEST(RigController, RecordsTheWholeSession) {
  const TemporaryFolder folder;
  const std::string out = folder / "run.csv";
  const std::string rig = rig_file("paper_rig_fdva");
  ASSERT_EQ(controller({"--rig", rig, "--simulated", "--virtual-time", "--road", hill(folder), "--out", out}).status,
            0);
  const auto t = column(out, "t"), mode = column(out, "mode"), reason = column(out, "reason");
  ASSERT_EQ(t.size(), mode.size());
  EXPECT_EQ(mode.front(), static_cast<double>(firmware::Mode::ready));
  EXPECT_EQ(mode.back(), static_cast<double>(firmware::Mode::safe));
  EXPECT_GT(std::count(mode.begin(), mode.end(), static_cast<double>(firmware::Mode::ready)), 200)
      << "10 mm at 0.05 m/s";
  EXPECT_GT(std::count(mode.begin(), mode.end(), static_cast<double>(firmware::Mode::safe)), 400);
  EXPECT_EQ(reason.front(), 0.0);
  EXPECT_EQ(reason.back(), static_cast<double>(firmware::Reason::reference_ended));
  for (std::size_t k = 0; k < t.size(); ++k) EXPECT_EQ(t[k], static_cast<double>(k) / 1000.0);

  const std::string text = TemporaryFolder::read(out);
  EXPECT_THAT(text, AllOf(HasSubstr("\n# part 1, begun 20"), HasSubstr("\n# | kind = \"quarter_car\"\n"),
                          HasSubstr(", SHA-256 " + firmware::sha256(TemporaryFolder::read(rig)) + ";"),
                          HasSubstr("\n# mode: 0 idle, 1 arming"), HasSubstr("\n# ended by reference_ended, 20")));

  const firmware::Recording run = host_sim::read_recording(out, {}, 1000.0);
  EXPECT_EQ(run.time.front(), 0.0);
  EXPECT_EQ(run.size(), static_cast<std::size_t>(
                            std::count(mode.begin(), mode.end(), static_cast<double>(firmware::Mode::running))));
  for (std::size_t k = 0; k < run.size(); ++k) EXPECT_EQ(run.time[k], static_cast<double>(k) / 1000.0);
}

// A law's table decides the run as the description does: it is in the recording, too.
TEST(RigController, RecordsTheTablesOfTheDescription) {
  const TemporaryFolder folder;
  const std::string out = folder / "run.csv";
  const std::string rig = folder.write("rig.toml", TemporaryFolder::read(rig_file("paper_rig_fdva")) +
                                                       "\n[laws.damper]\nplace = \"suspension\"\nover = \"velocity\"\n"
                                                       "file = \"damper.csv\"\n");
  const std::string table = "v [mm/s],F [N]\n-100,-5\n100,5\n";
  folder.write("damper.csv", table);
  ASSERT_EQ(controller({"--rig", rig, "--simulated", "--virtual-time", "--road", hill(folder), "--out", out}).status,
            0);
  EXPECT_THAT(TemporaryFolder::read(out), AllOf(HasSubstr("\n# table: " + (folder / "damper.csv").string() +
                                                          ", SHA-256 " + firmware::sha256(table) + ";"),
                                                HasSubstr("\n# | v [mm/s],F [N]\n")));
  EXPECT_GT(host_sim::read_recording(out, {}, 1000.0).size(), 0U);
}

/// A controller with a simulated rig that waits for its operator.
struct Operated {
  TemporaryFolder folder;
  std::string socket = folder / "control";
  Controller running;
  explicit Operated(const std::vector<std::string>& more = {})
      : running([&] {
          std::vector<std::string> words{"--rig",           patient_rig(folder), "--simulated", "--no-realtime",
                                         "--wait",          "--socket",          socket,        "--out",
                                         folder / "run.csv"};
          words.insert(words.end(), more.begin(), more.end());
          return words;
        }()) {}
  [[nodiscard]] Ended ask(const std::string& words) const {
    const std::string line = std::string(RIG_CONTROLLER_PROGRAM) + " --socket " + socket + " " + words;
    return Controller({"-c", "exec " + line}, "/bin/sh").program.wait();
  }
  [[nodiscard]] bool comes_to(const std::string& state) const {
    for (int i = 0; i < 1000; ++i) {
      if (ask("state").output.find("\"state\": \"" + state + "\"") != std::string::npos) return true;
    }
    return false;
  }
};

// The description may name the socket: the program listens there, and a client that is given the description asks
// there. A relative path would depend on the folder of the service.
TEST(RigController, ListensWhereItsDescriptionSays) {
  const TemporaryFolder folder;
  const std::string socket = folder / "front.sock";
  const std::string text = TemporaryFolder::read(patient_rig(folder));
  const std::string rig =
      folder.write("front.toml", support::with(text, "[controller]\n", "[controller]\nsocket = \"" + socket + "\"\n"));
  Controller running({"--rig", rig, "--simulated", "--no-realtime", "--wait", "--out", folder / "run.csv"});
  ASSERT_TRUE(running.says("waiting for the operator"));
  EXPECT_THAT(controller({"--rig", rig, "state"}).output, HasSubstr("\"state\": \"idle\""));
  ::kill(running.program.id(), SIGTERM);
  EXPECT_EQ(running.program.wait().status, 0);
  const std::string relative =
      folder.write("relative.toml", support::with(text, "[controller]\n", "[controller]\nsocket = \"front.sock\"\n"));
  const Ended refused = controller({"--rig", relative, "state"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.errors, HasSubstr("controller.socket = 'front.sock' does not fit, expected an absolute path"));
}

// The operator arms, starts, holds, goes on, scales and stops by the socket; each answer is one line of JSON. A run
// that was acknowledged is started again by the same program, into a recording of its own.
TEST(RigController, IsOperatedByItsSocket) {
  Operated rig;
  ASSERT_TRUE(rig.running.says("waiting for the operator"));
  const Ended idle = rig.ask("state");
  EXPECT_EQ(idle.status, 0) << idle.errors;
  EXPECT_THAT(idle.output, AllOf(HasSubstr("{\"ok\": true"), HasSubstr("\"state\": \"idle\"")));
  EXPECT_EQ(std::count(idle.output.begin(), idle.output.end(), '\n'), 1);

  const Ended early = rig.ask("start");
  EXPECT_EQ(early.status, 6);
  EXPECT_THAT(early.output, HasSubstr("\"error\": \"start needs state armed, the rig is idle\""));
  EXPECT_EQ(rig.ask("jump").status, 2);
  EXPECT_EQ(rig.ask("level 3").status, 6);

  for (int run = 1; run <= 2; ++run) {
    EXPECT_EQ(rig.ask("arm").status, 0);
    ASSERT_TRUE(rig.comes_to("armed"));
    EXPECT_EQ(rig.ask("start").status, 0);
    ASSERT_TRUE(rig.comes_to("running"));
    EXPECT_EQ(rig.ask("level 0.8").status, 0);
    EXPECT_EQ(rig.ask("mark a knock, left").status, 0);
    EXPECT_EQ(rig.ask("hold").status, 0);
    ASSERT_TRUE(rig.comes_to("holding"));
    EXPECT_EQ(rig.ask("resume").status, 0);
    ASSERT_TRUE(rig.comes_to("running"));
    EXPECT_EQ(rig.ask("stop").status, 0);
    ASSERT_TRUE(rig.comes_to("safe"));
    for (int i = 0; i < 1000 && rig.ask("state").output.find("\"at_rest\": true") == std::string::npos; ++i) {
    }
    EXPECT_EQ(rig.ask("acknowledge").status, 0);
    ASSERT_TRUE(rig.comes_to("idle"));
  }
  ::kill(rig.running.program.id(), SIGTERM);
  const Ended ended = rig.running.program.wait();
  EXPECT_EQ(ended.status, 0) << ended.errors;
  EXPECT_FALSE(std::filesystem::exists(rig.socket));
  for (const char* part : {"run.csv", "run-0002.csv"}) {
    const std::string text = TemporaryFolder::read(rig.folder / part);
    EXPECT_THAT(text, AllOf(HasSubstr("\n# mark: a knock, left, 20"), HasSubstr("\n# mark: operator: level 0.8, 20")));
    const auto level = column(rig.folder / part, "level");
    EXPECT_LT(*std::min_element(level.begin(), level.end()), 1.0);
    EXPECT_GT(level.size(), 10U);
    // A busy machine can miss more periods than the reader bridges.
    const auto t = column(rig.folder / part, "t");
    const bool misses_a_period =
        std::adjacent_find(t.begin(), t.end(), [](double a, double b) { return b - a > 1.5 / 100.0; }) != t.end();
    if (!misses_a_period) {
      EXPECT_GT(host_sim::read_recording(rig.folder / part, {}, 100.0).size(), 10U);
    }
  }
  EXPECT_EQ(rig.ask("state").status, 6) << "nobody listens";
}

// The socket belongs to one program, and only its user and the group rig may connect.
TEST(RigController, SharesItsSocketWithNobody) {
  Operated rig;
  ASSERT_TRUE(rig.running.says("waiting for the operator"));
  struct stat status {};
  ASSERT_EQ(::stat(rig.socket.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
  const Ended second = controller({"--rig", patient_rig(rig.folder), "--simulated", "--no-realtime", "--wait",
                                   "--socket", rig.socket, "--out", rig.folder / "second.csv"});
  EXPECT_EQ(second.status, 6);
  EXPECT_THAT(second.errors, HasSubstr("another rig_controller listens there"));
  EXPECT_EQ(second.error_lines(), 1);
  ::kill(rig.running.program.id(), SIGTERM);
  EXPECT_EQ(rig.running.program.wait().status, 0);
}

// An earlier recording is not overwritten silently.
TEST(RigController, KeepsAnEarlierRecording) {
  const TemporaryFolder folder;
  const std::string out = folder.write("run.csv", "of yesterday\n");
  std::vector<std::string> words{
      "--rig", rig_file("paper_hil_fdva"), "--simulated", "--virtual-time", "--duration", "1", "--out", out};
  const Ended refused = controller(words);
  EXPECT_EQ(refused.status, 4);
  EXPECT_THAT(refused.errors, HasSubstr("run.csv: File exists, expected a new name or --overwrite"));
  EXPECT_EQ(refused.error_lines(), 1);
  EXPECT_EQ(TemporaryFolder::read(out), "of yesterday\n");
  words.emplace_back("--overwrite");
  EXPECT_EQ(controller(words).status, 0);
  EXPECT_EQ(host_sim::read_recording(out, {}, 1000.0).size(), 1000U);
}

// A long recording has parts. Each is read alone; together they hold every row.
TEST(RigController, RollsItsRecordingOver) {
  const TemporaryFolder folder;
  ASSERT_EQ(controller({"--rig", rig_file("paper_hil_fdva"), "--simulated", "--virtual-time", "--duration", "20",
                        "--part-minutes", "0.1", "--out", folder / "run.csv"})
                .status,
            0);
  std::size_t rows = 0;
  for (const char* part : {"run.csv", "run-0002.csv", "run-0003.csv", "run-0004.csv"}) {
    rows += host_sim::read_recording(folder / part, {}, 1000.0).size();
    EXPECT_THAT(TemporaryFolder::read(folder / part), HasSubstr("\n# | kind = "));
  }
  EXPECT_EQ(rows, 20'000U);
  EXPECT_FALSE(std::filesystem::exists(folder / "run-0005.csv"));
  EXPECT_THAT(TemporaryFolder::read(folder / "run.csv"), HasSubstr("run-0002.csv, 20"));
}

// A road that repeats: cycles are counted in a column, and a replay gives the same rows.
TEST(RigController, RepeatsItsRoad) {
  const TemporaryFolder folder;
  const std::string run = folder / "run.csv", again = folder / "again.csv";
  const std::vector<std::string> road{"--rig", rig_file("paper_hil_fdva"), "--duration", "10", "--cycles", "3"};
  auto drive = road, replay = road;
  drive.insert(drive.end(), {"--simulated", "--virtual-time", "--out", run});
  replay.insert(replay.end(), {"--replay", run, "--out", again});
  ASSERT_EQ(controller(drive).status, 0);
  const auto cycle = column(run, "cycle");
  EXPECT_EQ(std::count(cycle.begin(), cycle.end(), 1.0), 8000);
  EXPECT_EQ(std::count(cycle.begin(), cycle.end(), 2.0), 8000);
  EXPECT_EQ(std::count(cycle.begin(), cycle.end(), 3.0) + std::count(cycle.begin(), cycle.end(), 4.0), 10'000);
  ASSERT_EQ(controller(replay).status, 0);
  EXPECT_EQ(rows_of(TemporaryFolder::read(again)), rows_of(TemporaryFolder::read(run)));
}

// A run that was stopped, or ended by a limit, is replayed with its stop and its limit: the same rows to the end.
TEST(RigController, ReplaysStopsAndLimits) {
  const TemporaryFolder folder;
  const std::string wild =  // a stable rig, at a third of the energy that it feeds on a road
      folder.write("wild.toml", std::string(support::hil_text) + "[limits]\nspeed = 1.5\nenergy_gain = 0.3\n");
  ASSERT_EQ(
      controller({"--rig", wild, "--simulated", "--virtual-time", "--out", folder / "wild.csv", "--road", "iso8608:B"})
          .status,
      7);
  const Ended tripped = controller(
      {"--rig", wild, "--replay", folder / "wild.csv", "--road", "iso8608:B", "--out", folder / "again.csv"});
  EXPECT_EQ(tripped.status, 7) << tripped.errors;
  EXPECT_THAT(last_line(tripped.output), HasSubstr("ended by energy ("));
  EXPECT_EQ(rows_of(TemporaryFolder::read(folder / "again.csv")), rows_of(TemporaryFolder::read(folder / "wild.csv")));

  const std::string rig = patient_rig(folder);
  Controller running({"--rig", rig, "--simulated", "--no-realtime", "--duration", "60", "--out", folder / "run.csv"});
  ASSERT_TRUE(running.says("running: "));
  wait_until_it_moves(folder / "run.csv");
  ::kill(running.program.id(), SIGTERM);
  ASSERT_EQ(running.program.wait().status, 0);
  const Ended stopped = controller({"--rig", rig, "--replay", folder / "run.csv", "--out", folder / "replayed.csv"});
  EXPECT_EQ(stopped.status, 0) << stopped.errors;
  EXPECT_THAT(last_line(stopped.output), HasSubstr("ended by stop_requested"));
  EXPECT_EQ(rows_of(TemporaryFolder::read(folder / "replayed.csv")),
            rows_of(TemporaryFolder::read(folder / "run.csv")));
}

// What the operator did is replayed as well: a level before the start and during the run, hold, resume, stop. A level changes with the
// reference, so it comes to rest before the hold.
TEST(RigController, ReplaysLevelAndHold) {
  Operated rig;
  ASSERT_TRUE(rig.running.says("waiting for the operator"));
  EXPECT_EQ(rig.ask("level 0.9").status, 0);
  EXPECT_EQ(rig.ask("arm").status, 0);
  ASSERT_TRUE(rig.comes_to("armed"));
  EXPECT_EQ(rig.ask("start").status, 0);
  ASSERT_TRUE(rig.comes_to("running"));
  const std::string run = rig.folder / "run.csv", again = rig.folder / "again.csv";
  EXPECT_EQ(rig.ask("level 0.6").status, 0);
  ASSERT_TRUE(comes([&] { return whole_rows(run, "level").back() == 0.6; }));
  EXPECT_EQ(rig.ask("hold").status, 0);
  ASSERT_TRUE(rig.comes_to("holding"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  EXPECT_EQ(rig.ask("resume").status, 0);
  EXPECT_EQ(rig.ask("level 1.2").status, 0);
  // It begins when the reference is under way, after a second.
  ASSERT_TRUE(comes([&] { return whole_rows(run, "level").back() > 0.6; }));
  EXPECT_EQ(rig.ask("stop").status, 0);
  ASSERT_TRUE(rig.comes_to("safe"));
  ::kill(rig.running.program.id(), SIGTERM);
  ASSERT_EQ(rig.running.program.wait().status, 0);
  const auto level = column(run, "level");
  ASSERT_GT(level.size(), 150U);
  EXPECT_GT(std::count(level.begin(), level.end(), 0.6), 10);
  EXPECT_GT(level.back(), 0.6) << "stopped in the middle of a change";
  const Ended replayed = controller({"--rig", patient_rig(rig.folder), "--replay", run, "--out", again});
  EXPECT_EQ(replayed.status, 0) << replayed.errors;
  EXPECT_EQ(rows_of(TemporaryFolder::read(again)), rows_of(TemporaryFolder::read(run)));
}

// A programme runs block by block, counts them, stands in its pauses, is looked at as a whole, and is replayed.
TEST(RigController, DrivesAProgramme) {
  const TemporaryFolder folder;
  const std::string blocks =
      "[[blocks]]\nroad = 'iso8608:A'\nduration = 10\nrepetitions = 2\npause = 3\n"
      "[[blocks]]\nroad = 'iso8608:B'\nduration = 8\nlevel = 0.5\nseed = 3\n";
  const std::string day = folder.write("day.toml", blocks), run = folder / "run.csv", again = folder / "again.csv";
  const std::string rig = rig_file("paper_rig_fdva");
  const Ended driven = controller({"--rig", rig, "--simulated", "--virtual-time", "--programme", day, "--out", run});
  ASSERT_EQ(driven.status, 0) << driven.errors;
  const auto block = column(run, "block"), cycle = column(run, "cycle");
  EXPECT_EQ(std::count(block.begin(), block.end(), 1.0), 8000 + 10'000 + 3000);
  EXPECT_EQ(std::count(block.begin(), block.end(), 2.0), 8000);
  EXPECT_EQ(std::count(cycle.begin(), cycle.end(), 2.0), 10'000 + 3000);
  EXPECT_THAT(TemporaryFolder::read(run), AllOf(HasSubstr("# programme: "), HasSubstr("\n# | duration = 10\n")));
  ASSERT_EQ(controller({"--rig", rig, "--replay", run, "--programme", day, "--out", again}).status, 0);
  EXPECT_EQ(rows_of(TemporaryFolder::read(again)), rows_of(TemporaryFolder::read(run)));

  const std::string wild = folder.write("wild.toml", blocks + "[[blocks]]\nroad = 'iso8608:E'\nduration = 5\n");
  const Ended refused =
      controller({"--rig", rig, "--simulated", "--virtual-time", "--programme", wild, "--out", folder / "wild.csv"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.errors, HasSubstr("wild.toml: "));
  EXPECT_FALSE(std::filesystem::exists(folder / "wild.csv")) << "nothing has moved";
  EXPECT_EQ(controller({"--rig", rig, "--simulated", "--programme", day, "--road", "iso8608:A", "--out", run}).status,
            2);
}

// An operator gets no level beyond what the run bears: 1.5 times this road leaves the stroke.
TEST(RigController, LimitsTheLevelToWhatTheRunBears) {
  const TemporaryFolder roads;
  std::string road = "t [s],z_r [m]\n";
  for (int k = 0; k < 6001; ++k) {
    road += std::to_string(0.01 * k) + "," + std::to_string(0.05 * (1.0 - std::cos(0.01 * k))) + "\n";
  }
  Operated rig({"--road", roads.write("high.csv", road)});
  ASSERT_TRUE(rig.running.says("waiting for the operator"));
  EXPECT_TRUE(rig.running.says("level: at most 1.25, beyond it"));
  EXPECT_THAT(rig.ask("level 1.3").output, HasSubstr("expected 0 to 1.25: beyond it this run does not fit"));
  EXPECT_EQ(rig.ask("level 1.2").status, 0);
  ::kill(rig.running.program.id(), SIGTERM);
  EXPECT_EQ(rig.running.program.wait().status, 0);
}

// A program that stands still for longer than `gap` (a stop from the terminal's job control, a stalled machine) ends
// safe at its next period, without power, and says so in status, last line and recording.
TEST(RigController, EndsSafeAfterAStopOfTheProcess) {
  const TemporaryFolder folder;
  const std::string rig =
      folder.write("rig.toml", support::with(support::quarter_car_text, "sample_rate = 1000.0", "sample_rate = 100.0") +
                                   "[controller]\nlate_in_a_row = 1000000\n[supervision]\ngap = 0.5\n");
  const std::string out = folder / "run.csv";
  Controller running({"--rig", rig, "--simulated", "--no-realtime", "--duration", "60", "--out", out});
  ASSERT_TRUE(running.says("running: "));
  wait_until_it_moves(out);
  ::kill(running.program.id(), SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  ::kill(running.program.id(), SIGCONT);
  const Ended ended = running.program.wait();
  EXPECT_EQ(ended.status, 7) << ended.errors;
  EXPECT_THAT(last_line(ended.output), AllOf(HasSubstr("ended by gap ("), HasSubstr("held where it stopped")));
  EXPECT_EQ(column(out, "reason").back(), static_cast<double>(firmware::Reason::gap));
  EXPECT_EQ(column(out, "enabled").back(), 0.0);
}

// kill −9: no goodbye. What lies there is whole up to the last second, every row of it.
TEST(RigController, LeavesWholeRowsWhenKilled) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run.csv").string();
  Controller running(
      {"--rig", rig_file("paper_hil_fdva"), "--simulated", "--virtual-time", "--duration", "3600", "--out", out});
  ASSERT_TRUE(running.says("running: "));
  for (int i = 0; i < 1000 && std::filesystem::file_size(out) < 1'000'000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::kill(running.program.id(), SIGKILL);
  EXPECT_EQ(running.program.wait().status, -SIGKILL);
  const std::string text = TemporaryFolder::read(out);
  ASSERT_FALSE(text.empty());
  const std::string whole = text.substr(0, text.rfind('\n') + 1);
  EXPECT_LT(text.size() - whole.size(), 512U) << "at most one row is torn";
  const firmware::Recording recording = firmware::parse_recording_csv(whole, "run.csv", {}, 1000.0);
  EXPECT_GT(recording.size(), 100U);
}

// Fault. A disk that is full ends the run in the safe state; the rows until then are whole and readable.
TEST(RigController, SurvivesAFullDisk) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run.csv").string();
  const std::string command = std::string("ulimit -f 200; exec ") + RIG_CONTROLLER_PROGRAM + " --rig " +
                              rig_file("paper_rig_fdva") + " --simulated --virtual-time --duration 600 --out " + out;
  const Ended ended = Controller({"-c", command}, "/bin/sh").program.wait();
  EXPECT_EQ(ended.status, 4) << ended.errors;
  EXPECT_NE(last_line(ended.output).find("ended by the recording cannot be written: File too large; valves safe"),
            std::string::npos)
      << last_line(ended.output);
  EXPECT_GT(host_sim::read_recording(out, {}, 1000.0).size(), 100U);
}

// Each way to be refused: one line, and a status that says which.
TEST(RigController, RefusesInOneLine) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run.csv").string();
  const std::string hil = rig_file("paper_hil_fdva");
  struct Case {
    std::vector<std::string> arguments;
    int status;
    std::string words;
  };
  const std::vector<Case> cases{
      {{"--rig", hil}, 2, "--out is missing"},
      {{"--rig", hil, "--out", out, "--wait", "--start"}, 2, "--wait and --start"},
      {{"--rig", hil, "--out", out, "--simulated", "--virtual-time", "--wait"}, 2, "--wait needs a rig in real time"},
      {{"--socket", "/no/such/socket", "arm"}, 6, "no program listens there"},
      {{"--socket", "/no/such/socket", "jump"}, 2, "unknown command 'jump'"},
      {{"--out", out}, 2, "--rig is missing"},
      {{"--rig", hil, "--out", out, "--fast"}, 2, "unknown option --fast"},
      {{"--rig", hil, "--out", out, "--histogram", out}, 2, "--histogram and --out name one file"},
      {{"--rig", hil, "--out", out, "--simulated", "--virtual-time", "--histogram", "/no/such/folder"},
       4,
       "/no/such/folder: cannot be created"},
      {{"--rig", hil, "--out", out, "--duration", "x"}, 2, "--duration x does not fit"},
      {{"--rig", hil, "--out", out, "--duration"}, 2, "--duration needs a value"},
      {{"--rig", hil, "--out", out, "--virtual-time"}, 2, "--virtual-time needs --simulated"},
      {{"--rig", hil, "--out", out, "--simulated", "--virtual-time", "--road", "x.csv"}, 3, "x.csv: cannot be opened"},
      {{"--rig", hil, "--out", out, "--simulated", "--virtual-time", "--road", "iso8608:K"},
       2,
       "unknown road class 'K'"},
      {{"--rig", hil, "--out", out, "--simulated", "--virtual-time", "--road", "x.csv", "--cut-off", "1"},
       2,
       "--bandwidth and --cut-off shape an ISO 8608 road"},
      {{"--rig", hil, "--out", out, "--replay", "x.csv"}, 3, "x.csv: cannot be opened"},
      {{"--rig", hil, "--out", out, "--replay", "x.csv", "--simulated"}, 2, "--replay and --simulated"},
      {{"--rig", hil, "--out", out, "--replay", out}, 2, "--replay and --out name one file"},
      {{"--rig", "no.toml", "--out", out}, 3, "no.toml: cannot be opened"},
      {{"--rig", hil, "--out", out}, 6, "no table [gpio]"},
      {{"--rig", hil, "--out", "/no/such/folder.csv", "--simulated", "--virtual-time"}, 4, "No such file or directory"},
      {{"--rig", hil, "--out", "/dev/full", "--simulated", "--virtual-time"}, 4, "No space left on device"},
  };
  for (const Case& c : cases) {
    const Ended ended = controller(c.arguments);
    EXPECT_EQ(ended.status, c.status) << c.words;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(c.words), std::string::npos) << ended.errors;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

// The histogram is there when the run has ended; one that cannot be written then is told beside the last line.
TEST(RigController, WritesItsHistograms) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& file) {
    return controller({"--rig", rig_file("paper_hil_fdva"), "--simulated", "--virtual-time", "--duration", "1", "--out",
                       folder / "run.csv", "--overwrite", "--histogram", file});
  };
  EXPECT_EQ(run(folder / "run.us").status, 0);
  const std::string text = TemporaryFolder::read(folder / "run.us");
  EXPECT_NE(text.find("\n# Total: 000001"), std::string::npos) << text;

  const Ended full = run("/dev/full");
  EXPECT_EQ(full.status, 4);
  EXPECT_NE(full.errors.find("/dev/full: cannot be written"), std::string::npos) << full.errors;
  EXPECT_NE(last_line(full.output).find("ended by reference_ended; valves safe, command at rest, 1"),
            std::string::npos);
}

// A trip is a safe stop with a status of its own, which systemd takes as a wish to stay down.
TEST(RigController, SaysWhatTripped) {
  const TemporaryFolder folder;
  const std::string rig =
      folder.write("wild.toml", std::string(support::hil_text) + "[limits]\nspeed = 1.5\nenergy_gain = 0.3\n");
  const Ended ended = controller(
      {"--rig", rig, "--simulated", "--virtual-time", "--out", (folder / "run.csv").string(), "--road", "iso8608:A"});
  EXPECT_EQ(ended.status, 7);
  EXPECT_NE(last_line(ended.output).find("ended by energy ("), std::string::npos) << last_line(ended.output);
  EXPECT_LT(host_sim::read_recording(folder / "run.csv", {}, 1000.0).size(), 2000U);
}

// The whole run and the limits are looked at before anything moves: status 3, one line, no recording.
TEST(RigController, RefusesARunThatItsLimitsWouldEnd) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run.csv").string();
  std::string millimetres = "t,z_r\n";
  for (int k = 0; k < 3000; ++k) {
    const double hill = 1.0 - std::cos(6.283185307179586 * 0.5 * 1e-3 * k);
    millimetres += std::to_string(1e-3 * k) + "," + std::to_string(9.0 * hill * hill) + "\n";
  }
  const std::string road = folder.write("road.csv", millimetres).string();
  const std::string cell =
      folder.write("cell.toml", std::string(support::hil_text) + "[range]\nF = [-1e4, 1e4]\n[limits]\nforce = 25e3\n")
          .string();
  struct Case {
    std::vector<std::string> arguments;
    std::string says;
  };
  for (const Case& c : {Case{{"--rig", rig_file("paper_rig_fdva"), "--road", road}, "a road in millimetres?"},
                        Case{{"--rig", rig_file("paper_hil_fdva"), "--road", road}, "a road in millimetres?"},
                        Case{{"--rig", rig_file("paper_rig_fdva"), "--road", "iso8608:E"}, "the command steps with "},
                        Case{{"--rig", cell}, "limits.force = 2.5e+04 N can never trip"}}) {
    std::vector<std::string> arguments{"--simulated", "--virtual-time", "--duration", "3", "--out", out};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const Ended ended = controller(arguments);
    EXPECT_EQ(ended.status, 3) << c.says;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_THAT(ended.errors, HasSubstr(c.says));
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

// A hil rig on devices needs a proof of its loop; the simulated one does not.
TEST(RigController, RefusesALoopThatNobodyFoundStable) {
  const TemporaryFolder folder;
  const std::string example = TemporaryFolder::read(support::source / "firmware/controller/rigs/example_hil.toml");
  const std::size_t proven = example.find("proven = "), end = example.find('\n', proven);
  ASSERT_NE(proven, std::string::npos);
  const std::string rig = folder.write("rig.toml", example.substr(0, proven) + example.substr(end + 1)).string();
  for (const bool check : {true, false}) {
    std::vector<std::string> arguments{"--rig", rig, "--out", (folder / "run.csv").string()};
    if (check) arguments = {"--rig", rig, "--check"};
    const Ended ended = controller(arguments);
    EXPECT_EQ(ended.status, 3);
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_THAT(ended.errors, HasSubstr("nothing says that this loop is stable"));
  }
  EXPECT_EQ(controller({"--rig", rig, "--simulated", "--virtual-time", "--duration", "1", "--out", "/dev/null"}).status,
            0);
}

// What a newcomer begins with is whole: it passes every check but that of the devices, which are not here.
TEST(RigController, TakesItsExamples) {
  for (const char* name : {"example_rig", "example_hil"}) {
    const std::string rig = (support::source / "firmware/controller/rigs" / (std::string(name) + ".toml")).string();
    const Ended ended = controller({"--rig", rig, "--check"});
    EXPECT_EQ(ended.status, 6);
    EXPECT_NE(ended.errors.find("GPIO chip 'rig-bank' is not there"), std::string::npos) << ended.errors;
    EXPECT_EQ(
        controller({"--rig", rig, "--simulated", "--virtual-time", "--duration", "2", "--out", "/dev/null"}).status, 0);
  }
}

// The seal of the heap sees every way to take and to give, by C and by C++, aligned or not.
TEST(RigController, SealsItsHeap) {
  const TemporaryFolder streams;
  const Ended ended = support::RunningProgram(streams, {}, {}, RIGTWIN_HEAP_SEAL_PROBE).wait();
  if (ended.output.find("malloc 0") != std::string::npos) GTEST_SKIP() << "this build has a malloc of its own";
  EXPECT_EQ(
      ended.output,
      "nothing 0\nmalloc 1\nrealloc 1\nfree 1\nfree nullptr 0\naligned_alloc 1\naligned new 1\naligned delete 1\n");
}

// A rig with a stroke of 1 m at 0.02 m/s needs 150 s to come back: systemd waits for it.
TEST(RigController, PrintsTheTimesOfItsUnit) {
  const TemporaryFolder folder;
  const Ended paper = controller({"--rig", rig_file("paper_rig_fdva"), "--unit-times"});
  EXPECT_EQ(paper.status, 0) << paper.errors;
  EXPECT_THAT(paper.output, HasSubstr("\n[Service]\nWatchdogSec=2\nTimeoutStopSec=27\nTimeoutAbortSec=27\n"));
  const std::string slow =
      folder.write("slow.toml", std::string(support::quarter_car_text) + "[limits]\nstroke = 1.0\nramp = 0.02\n");
  EXPECT_THAT(controller({"--rig", slow, "--unit-times"}).output, HasSubstr("\nTimeoutStopSec=162\n"));
  EXPECT_EQ(controller({"--unit-times"}).status, 2);
}

TEST(RigController, ListsAndHelps) {
  EXPECT_EQ(controller({"--list"}).status, 0);
  EXPECT_NE(controller({"--help"}).output.find("--no-realtime"), std::string::npos);
  EXPECT_EQ(controller({"--version"}).output.find("rig_controller "), 0U);
}

}  // namespace
