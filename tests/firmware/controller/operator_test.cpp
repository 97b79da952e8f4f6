// The operator's socket and the files of a run where others want them too.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/controller/control_socket.hpp"
#include "firmware/description/text/input_error.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace operator_test {
namespace {

namespace fs = std::filesystem;
using support::Ended;
using support::GuardedProgram;
using support::rig_file;
using support::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A rig on a machine that may be busy: neither late periods end a run, nor the delay that they are in a hil loop.
std::string patient(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  return folder.write(name, text +
                                "\n[supervision]\ngap = 1.0\ngrowth_time = 2.0\nenergy_cycles = 1000\n"
                                "[controller]\nlate_in_a_row = 1000000\n");
}

Ended run(const std::vector<std::string>& words) {
  const TemporaryFolder streams;
  return support::RunningProgram(streams, words, {}, RIG_CONTROLLER_PROGRAM).wait();
}

/// The rows of a recording, without its comments.
std::vector<std::string> rows_of(const std::string& file) {
  std::istringstream text(TemporaryFolder::read(file));
  std::vector<std::string> rows;
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with('#')) rows.push_back(line);
  }
  return rows;
}

/// A client that says what it is told and hears what comes.
class Client {
 public:
  explicit Client(const std::string& path, int flags = 0)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | flags, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), address.sun_path);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    const timeval patience{20, 0};  // a hang
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  Client(Client&& other) noexcept : socket_(std::exchange(other.socket_, -1)), connected_(other.connected_) {}
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  Client& operator=(Client&&) = delete;
  ~Client() {
    if (socket_ >= 0) ::close(socket_);
  }
  [[nodiscard]] bool connected() const { return connected_; }
  void say(const std::string& text) const {
    static_cast<void>(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
  }
  /// The next line; empty: the connection has ended.
  [[nodiscard]] std::string line() const {
    std::string text;
    for (char c = 0; ::recv(socket_, &c, 1, 0) == 1 && c != '\n';) text += c;
    return text;
  }
  [[nodiscard]] std::string ask(const std::string& words) const {
    say(words + "\n");
    return line();
  }

 private:
  int socket_;
  bool connected_ = false;
};

struct Waiting : testing::Test {
  TemporaryFolder folder;
  std::string socket = folder / "control";
  std::string out = folder / "run.csv";

  [[nodiscard]] GuardedProgram controller(const std::string& rig, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"--rig", rig, "--simulated", "--no-realtime", "--wait", "--socket", socket,
                                   "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    return GuardedProgram(streams, words, {}, RIG_CONTROLLER_PROGRAM);
  }
  /// Until somebody listens.
  [[nodiscard]] bool listens() const {
    for (int i = 0; i < 3000; ++i) {
      if (Client(socket).connected()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  [[nodiscard]] bool comes_to(const std::string& words) const {
    const Client client(socket);
    for (int i = 0; i < 3000; ++i) {
      if (client.ask("state").find(words) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  [[nodiscard]] bool runs() const {
    static_cast<void>(Client(socket).ask("arm"));
    if (!comes_to("\"state\": \"armed\"")) return false;
    static_cast<void>(Client(socket).ask("start"));
    return comes_to("\"state\": \"running\"");
  }
  [[nodiscard]] std::string hil() const {
    return patient(folder, "hil.toml", TemporaryFolder::read(rig_file("paper_hil_fdva")));
  }
  TemporaryFolder streams;
};

// Fault. Clients that connect and say nothing keep nobody out, and a stop is heard although every place is taken and a
// line stands before it.
TEST_F(Waiting, HearsAStopAmongSilentClients) {
  GuardedProgram program = controller(hil());
  ASSERT_TRUE(listens());
  std::vector<Client> silent;
  for (int i = 0; i < 40; ++i) silent.emplace_back(socket);
  ASSERT_TRUE(runs());
  for (int i = 0; i < 40; ++i) silent.emplace_back(socket);
  const Client client(socket);
  client.say("state\nstop\n");
  EXPECT_THAT(client.line(), HasSubstr("\"command\": \"state\""));
  EXPECT_THAT(client.line(), AllOf(HasSubstr("\"ok\": true, \"command\": \"stop\""), HasSubstr("\"state\": \"safe\"")));
  const Client halved(socket);
  halved.say("sta");
  EXPECT_THAT(Client(socket).ask("state"), HasSubstr("\"reason\": \"stop_requested\""));
  ::kill(program.id(), SIGTERM);
  EXPECT_EQ(program.wait().status, 0);
}

// A command that says more than it means, and one that the rig's state does not allow.
TEST_F(Waiting, RefusesWhatItWouldNotDo) {
  GuardedProgram program = controller(hil());
  ASSERT_TRUE(listens());
  const Client client(socket);
  EXPECT_THAT(client.ask("hold now"), AllOf(HasSubstr("\"ok\": false"), HasSubstr("hold takes nothing behind it")));
  EXPECT_THAT(client.ask("state x y"), HasSubstr("\"ok\": false"));
  EXPECT_THAT(client.ask("stop it"), HasSubstr("\"ok\": false"));
  EXPECT_THAT(client.ask("@ arm"), HasSubstr("arm is for the program '', this is ")) << "a page that knows no instance";
  EXPECT_THAT(client.ask("state"), HasSubstr("\"state\": \"idle\""));
  EXPECT_THAT(client.ask("@another.1@machine arm"),
              AllOf(HasSubstr("\"ok\": false"), HasSubstr("arm is for the program 'another.1@machine', this is ")));
  const std::string state = client.ask("state");
  const std::size_t at = state.find("\"instance\": \"") + 13;
  const std::string instance = state.substr(at, state.find('"', at) - at);
  EXPECT_THAT(client.ask("@" + instance + " arm"), HasSubstr("\"ok\": true"));
  EXPECT_THAT(client.ask("stop \r"), HasSubstr("\"ok\": true, \"command\": \"stop\"")) << "as terminals send it";
  ::kill(program.id(), SIGTERM);
  EXPECT_EQ(program.wait().status, 0);
}

// On the way back nothing is acknowledged and nothing begins: the answer says so.
TEST_F(Waiting, AcknowledgesNothingInMotion) {
  std::string road = "t,z_r\n";
  for (int k = 0; k <= 3000; ++k) {
    const double s = std::min(1.0, k / 100.0);
    road += std::to_string(0.01 * k) + "," + std::to_string(0.03 * s * s * (3.0 - 2.0 * s)) + "\n";
  }
  const std::string rig = patient(
      folder, "car.toml",
      support::with(TemporaryFolder::read(rig_file("paper_rig_fdva")), "sample_rate = 1000.0", "sample_rate = 100.0"));
  GuardedProgram program = controller(rig, {"--road", folder.write("road.csv", road)});
  ASSERT_TRUE(listens());
  ASSERT_TRUE(runs());
  ASSERT_TRUE(comes_to("\"command_m\": 0.03")) << "where the road stays";
  const Client client(socket);
  client.say("stop\nacknowledge\nrest\n");
  EXPECT_THAT(client.line(), HasSubstr("\"at_rest\": false"));
  for (const char* word : {"acknowledge", "rest"}) {
    EXPECT_THAT(client.line(),
                AllOf(HasSubstr("\"ok\": false"), HasSubstr(word), HasSubstr("still moves or has power")));
  }
  ::kill(program.id(), SIGTERM);
  EXPECT_EQ(program.wait().status, 0);
  // What was seen while it waited for its operator is not on record, so it counts for nothing: v_r, v_w and v_b come again.
  const Ended again =
      run({"--rig", rig, "--road", folder / "road.csv", "--replay", out, "--out", folder / "again.csv"});
  EXPECT_EQ(again.status, 0) << again.errors;
  EXPECT_EQ(rows_of(folder / "again.csv"), rows_of(out));
}

// Fault. A program that hangs does not make its clients hang.
TEST_F(Waiting, IsLeftByItsClientsWhenItHangs) {
  GuardedProgram program = controller(hil());
  ASSERT_TRUE(listens());
  ::kill(program.id(), SIGSTOP);
  const Ended ended = run({"--socket", socket, "state"});
  ::kill(program.id(), SIGCONT);
  EXPECT_EQ(ended.status, 6);
  EXPECT_THAT(ended.errors, HasSubstr("no answer; whether the program has taken 'state' is unknown"));
}

// Fault. The place of a socket belongs to the program that listens there now.
TEST_F(Waiting, LeavesAnothersSocketAlone) {
  GuardedProgram first = controller(hil());
  ASSERT_TRUE(listens());
  fs::remove(socket);
  const std::string second_out = folder / "second.csv";
  const TemporaryFolder more_streams;
  GuardedProgram second(
      more_streams, {"--rig", hil(), "--simulated", "--no-realtime", "--wait", "--socket", socket, "--out", second_out},
      {}, RIG_CONTROLLER_PROGRAM);
  ASSERT_TRUE(listens());
  ::kill(first.id(), SIGTERM);
  EXPECT_EQ(first.wait().status, 0);
  EXPECT_TRUE(Client(socket).connected()) << "the second one is still asked there";
  ::kill(second.id(), SIGKILL);
  static_cast<void>(second.wait());
  EXPECT_TRUE(fs::exists(socket));
  fs::remove(out);
  GuardedProgram third = controller(hil());
  EXPECT_TRUE(listens()) << "nobody answers there, so it is replaced";
}

// A socket replaces no file: the description lay there once.
TEST_F(Waiting, ReplacesNoFileByItsSocket) {
  const std::string rig = hil();
  const std::string before = TemporaryFolder::read(rig);
  const Ended ended = run({"--rig", rig, "--simulated", "--no-realtime", "--wait", "--socket", rig, "--out", out});
  EXPECT_EQ(ended.status, 6);
  EXPECT_THAT(ended.errors, HasSubstr("hil.toml: is a file and no socket"));
  EXPECT_EQ(TemporaryFolder::read(rig), before);
}

// Fault. A run that was refused its socket had emptied the earlier recording that it was to replace.
TEST_F(Waiting, EmptiesNoRecordingOfARunThatIsRefused) {
  const std::string rig = hil(), file = folder.write("file", "of yesterday\n");
  const std::string before = TemporaryFolder::read(folder.write("run.csv", "t\n0\n"));
  const Ended ended =
      run({"--rig", rig, "--simulated", "--no-realtime", "--wait", "--socket", file, "--out", out, "--overwrite"});
  EXPECT_EQ(ended.status, 6);
  EXPECT_EQ(TemporaryFolder::read(out), before);
  fs::remove(out);
  EXPECT_EQ(run({"--rig", rig, "--simulated", "--no-realtime", "--wait", "--socket", file, "--out", out}).status, 6);
  EXPECT_FALSE(fs::exists(out));
}

// Fault. More clients at once than the kernel keeps waiting: a client gave up at once, with its stop.
TEST_F(Waiting, HearsAStopBehindMoreClientsThanMayWait) {
  GuardedProgram program = controller(hil());
  ASSERT_TRUE(listens());
  ::kill(program.id(), SIGSTOP);
  std::vector<Client> crowd;
  for (bool room = true; room && crowd.size() < 1000;) {
    crowd.emplace_back(socket, SOCK_NONBLOCK);
    room = crowd.back().connected();
  }
  ASSERT_FALSE(crowd.back().connected());
  const TemporaryFolder more_streams;
  support::RunningProgram stop(more_streams, {"--socket", socket, "stop"}, {}, RIG_CONTROLLER_PROGRAM);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // it has found no place; sooner is no failure
  ::kill(program.id(), SIGCONT);
  const Ended stopped = stop.wait();
  EXPECT_EQ(stopped.status, 0) << stopped.errors;
  EXPECT_THAT(stopped.output, HasSubstr("\"ok\": true, \"command\": \"stop\""));
  ::kill(program.id(), SIGTERM);
  EXPECT_EQ(program.wait().status, 0);
}

// A run that tripped stays on record as such when its operator goes on: the reason with its numbers in its own part, a
// line at once on the console, and the status of the session.
TEST_F(Waiting, KeepsTheReasonOfEachRun) {
  const std::string rig =
      folder.write("wild.toml", std::string(support::hil_text) +
                                    "[limits]\nspeed = 1.5\nenergy_gain = 0.3\n[supervision]\ngap = 1.0\n"
                                    "[controller]\nlate_in_a_row = 1000000\n");
  GuardedProgram program = controller(rig, {"--road", "iso8608:A"});
  ASSERT_TRUE(listens());
  ASSERT_TRUE(runs() || comes_to("\"state\": \"safe\""));
  ASSERT_TRUE(comes_to("\"reason\": \"energy\""));
  ASSERT_TRUE(comes_to("\"at_rest\": true"));
  for (int i = 0; i < 3000 && TemporaryFolder::read(streams / "stderr.txt").empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_THAT(TemporaryFolder::read(streams / "stderr.txt"), HasSubstr("rig_controller: SAFE STOP: energy ("));
  EXPECT_THAT(Client(socket).ask("acknowledge"), HasSubstr("\"state\": \"idle\""));
  static_cast<void>(Client(socket).ask("arm"));
  ASSERT_TRUE(comes_to("\"state\": \"armed\""));
  ::kill(program.id(), SIGTERM);
  const Ended ended = program.wait();
  EXPECT_EQ(ended.status, 7);
  EXPECT_THAT(ended.output, HasSubstr("an earlier run of this session ended by energy ("));
  EXPECT_THAT(TemporaryFolder::read(out),
              testing::ContainsRegex("\n# ended by energy \\([^,]*, limit [^)]*\\)[^\n]*\n"));
  EXPECT_THAT(TemporaryFolder::read(folder / "run-0002.csv"), HasSubstr("\n# ended by a signal to stop"));
}

// A second program does not write where one writes already.
TEST_F(Waiting, SharesItsRecordingWithNobody) {
  GuardedProgram program = controller(hil());
  ASSERT_TRUE(listens());
  const Ended second =
      run({"--rig", rig_file("paper_hil_fdva"), "--simulated", "--virtual-time", "--overwrite", "--out", out});
  EXPECT_EQ(second.status, 4);
  EXPECT_THAT(second.errors, HasSubstr("run.csv: another program writes it"));
}

/// A short run in virtual time.
Ended short_run(const std::string& rig, const std::vector<std::string>& more) {
  std::vector<std::string> words{"--rig", rig, "--simulated", "--virtual-time", "--duration", "1"};
  words.insert(words.end(), more.begin(), more.end());
  return run(words);
}

// What a run reads it never writes, whatever name leads there.
TEST(Outputs, AreNoInputs) {
  const TemporaryFolder folder;
  const std::string text = TemporaryFolder::read(rig_file("paper_hil_fdva"));
  const std::string rig = folder.write("rig.toml", text), other = folder / "other.toml", out = folder / "run.csv";
  fs::create_hard_link(rig, other);
  const std::vector<std::vector<std::string>> all{{"--out", other, "--overwrite"},
                                                  {"--out", out, "--overwrite", "--histogram", other},
                                                  {"--out", out, "--overwrite", "--histogram", rig}};
  for (const auto& words : all) {
    const Ended ended = short_run(rig, words);
    EXPECT_EQ(ended.status, 4) << words.back();
    EXPECT_THAT(ended.errors, HasSubstr("is read by this run, expected another name"));
    EXPECT_EQ(TemporaryFolder::read(rig), text);
  }
  ASSERT_EQ(short_run(rig, {"--out", out}).status, 0);
  const std::string recorded = TemporaryFolder::read(out);
  const std::string same = folder / "same.csv";
  fs::create_hard_link(out, same);
  const Ended replay = run({"--rig", rig, "--replay", out, "--duration", "1", "--overwrite", "--out", same});
  EXPECT_EQ(replay.status, 4);
  EXPECT_EQ(TemporaryFolder::read(out), recorded);
}

// Links are not followed to a file that somebody else chose, and an earlier histogram is not replaced without a word.
TEST(Outputs, LeaveLinksAndEarlierFilesAlone) {
  const TemporaryFolder folder;
  const std::string rig = rig_file("paper_hil_fdva"), link = folder / "link.csv";
  fs::create_symlink(folder / "nowhere.csv", link);
  const Ended linked = short_run(rig, {"--out", link});
  EXPECT_EQ(linked.status, 4);
  EXPECT_THAT(linked.errors, HasSubstr("link.csv: is a link"));
  EXPECT_EQ(short_run(rig, {"--out", folder / "run.csv", "--histogram", link}).status, 4);
  EXPECT_FALSE(fs::exists(folder / "nowhere.csv"));
  const std::string earlier = folder.write("run.us", "of yesterday\n");
  EXPECT_EQ(short_run(rig, {"--out", folder / "run.csv", "--histogram", earlier}).status, 4);
  EXPECT_EQ(TemporaryFolder::read(earlier), "of yesterday\n");
  EXPECT_EQ(short_run(rig, {"--out", folder / "run.csv", "--overwrite", "--histogram", earlier}).status, 0);
}

// A name that a part will need is found taken before the run, not at the rollover.
TEST(Outputs, ClaimTheNamesOfPartsAtTheStart) {
  const TemporaryFolder folder;
  const std::string out = folder / "run.csv", second = folder.write("run-0002.csv", "of yesterday\n");
  const std::string rig = rig_file("paper_hil_fdva");
  const Ended refused = short_run(rig, {"--out", out, "--part-minutes", "0.01"});
  EXPECT_EQ(refused.status, 4);
  EXPECT_THAT(refused.errors, HasSubstr("run-0002.csv: File exists"));
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(TemporaryFolder::read(second), "of yesterday\n");
  EXPECT_EQ(short_run(rig, {"--out", out}).status, 0) << "without parts the name is free";
}

// Fault. Nobody reads a pipe: the program waited for a reader, and no signal ended it.
TEST(Outputs, WaitForNoReader) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Ended ended = short_run(rig_file("paper_hil_fdva"), {"--out", pipe});
  EXPECT_EQ(ended.status, 4);
  EXPECT_THAT(ended.errors, HasSubstr("pipe: is a pipe that nobody reads, expected a reader before the run"));
}

// Fault. The histogram of a run replaced the second part of its own recording.
TEST(Outputs, TakeNoNameOfAPart) {
  const TemporaryFolder folder;
  const Ended ended = short_run(rig_file("paper_hil_fdva"), {"--out", folder / "run.csv", "--part-minutes", "0.01",
                                                             "--histogram", folder / "./run-0002.csv"});
  EXPECT_EQ(ended.status, 4);
  EXPECT_THAT(ended.errors, HasSubstr("run-0002.csv: is the name of a part of --out "));
  EXPECT_FALSE(fs::exists(folder / "run.csv"));
}

// A name that no part can have is passed over, and what is no file has no parts: /dev/null-0002 was one.
TEST(Outputs, PassOverWhatIsNoFile) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "run-0002.csv");
  const std::string rig = rig_file("paper_hil_fdva");
  EXPECT_EQ(short_run(rig, {"--out", folder / "run.csv", "--overwrite", "--part-minutes", "0.01"}).status, 0);
  EXPECT_TRUE(fs::exists(folder / "run-0003.csv"));
  const std::string device = folder / "device";
  fs::create_symlink("/dev/null", device);
  EXPECT_EQ(short_run(rig, {"--out", device, "--part-minutes", "0.01"}).status, 0);
  EXPECT_FALSE(fs::exists(folder / "device-0002"));
}

// Parts as short as two periods roll over; shorter ones are refused.
TEST(Outputs, RollOverHoweverOften) {
  const TemporaryFolder folder;
  const std::string rig = rig_file("paper_hil_fdva");
  EXPECT_EQ(run({"--rig", rig, "--simulated", "--virtual-time", "--duration", "0.05", "--out", folder / "run.csv",
                 "--part-minutes", "0.0002"})
                .status,
            0);
  EXPECT_TRUE(fs::exists(folder / "run-0005.csv"));
  const Ended refused = short_run(rig, {"--out", folder / "b.csv", "--part-minutes", "1e-9"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.errors, HasSubstr("--part-minutes 1e-09 does not fit"));
  const Ended cut = short_run(rig, {"--out", folder / "b.csv", "--cut-off", "1e300"});
  EXPECT_EQ(cut.status, 2);
  EXPECT_THAT(cut.errors, HasSubstr("--cut-off 1e+300 leaves nothing of the road"));
}

// A client finds the program of a service without being told its socket, as long as there is one.
TEST(ClientsPath, FindsTheOnlyService) {
  using firmware::controller::clients_path;
  const TemporaryFolder folder;
  const auto listen = [&](const std::string& name) {
    fs::create_directories((folder / name).parent_path());
    const std::string path = folder / name;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), address.sun_path);
    const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::close(socket);
  };
  const std::string directory = folder.path();
  EXPECT_EQ(clients_path("", "", "", directory), folder / "control.sock");
  listen("front/control.sock");
  EXPECT_EQ(clients_path("", "", "", directory), folder / "front/control.sock");
  listen("rear/control.sock");
  EXPECT_THROW(static_cast<void>(clients_path("", "", "", directory)), firmware::UsageError);
  EXPECT_EQ(clients_path("", "", "/etc/rig_controller/rear.toml", directory), folder / "rear/control.sock");
  EXPECT_EQ(clients_path("", "/described", "rear.toml", directory), "/described");
  EXPECT_EQ(clients_path("/asked", "/described", "", directory), "/asked");
}

}  // namespace
}  // namespace operator_test
