// rigtwin watch beside a rig_controller with a simulated rig: from the loop to the page's events and back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

// Last: it defines _res as a macro, a name that Eigen uses.
#include <httplib.h>

namespace {

using nlohmann::json;
using support::Ended;
using support::GuardedProgram;
using support::TemporaryFolder;
using testing::HasSubstr;

constexpr auto hang = std::chrono::seconds(60);

/// rigtwin watch on free ports.
class Watch {
 public:
  explicit Watch(const std::string& socket)
      : program_(folder_, {"watch", "--port", "0", "--receive", "127.0.0.1:0", "--socket", socket}) {
    const auto until = std::chrono::steady_clock::now() + hang;
    std::string text;
    while (program_.running() && std::chrono::steady_clock::now() < until &&
           text.find("requests") == std::string::npos) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      text = TemporaryFolder::read(folder_ / "stdout.txt");
    }
    char token[33] = "";
    EXPECT_EQ(std::sscanf(text.c_str(), "http://localhost:%d/?token=%32[0-9a-f]", &port_, token), 2) << text;
    EXPECT_EQ(std::sscanf(text.c_str() + text.find("UDP"), "UDP 127.0.0.1:%d", &receive_), 1) << text;
    token_ = token;
  }
  [[nodiscard]] std::string publish_to() const { return "127.0.0.1:" + std::to_string(receive_); }

  /// Events until one satisfies: that one; null: none did before the test hung.
  template <class Wanted>
  json until(Wanted&& wanted) {
    httplib::Client client("127.0.0.1", port_);
    const auto end = std::chrono::steady_clock::now() + hang;
    std::string text;
    json found;
    static_cast<void>(client.Get("/events?token=" + token_, [&](const char* data, std::size_t size) {
      text.append(data, size);
      for (std::size_t at = text.find("\n\n"); at != std::string::npos && found.is_null(); at = text.find("\n\n")) {
        const json event = json::parse(text.substr(6, at - 6));
        text.erase(0, at + 2);
        if (wanted(event)) found = event;
      }
      return found.is_null() && std::chrono::steady_clock::now() < end;
    }));
    return found;
  }
  json until_state(const std::string& state) {
    return until([&](const json& event) { return event.value("state", "") == state && event["link"] == "live"; });
  }

  json ask(const std::string& request) {
    httplib::Client client("127.0.0.1", port_);
    const auto reply = client.Post("/ask", {{"X-Rigtwin-Token", token_}}, request, "text/plain");
    if (!reply || reply->status != 200) return {};
    return json::parse(json::parse(reply->body)["answer"].get<std::string>(), nullptr, false);
  }

  Ended end() {
    ::kill(program_.id(), SIGTERM);
    return program_.wait();
  }

 private:
  TemporaryFolder folder_;
  GuardedProgram program_;
  int port_ = 0;
  int receive_ = 0;
  std::string token_;
};

std::string patient(std::string_view text) {
  return std::string(text) + "[controller]\nlate_in_a_row = 1000000\n[supervision]\ngap = 1.0\n";
}

struct Rig {
  TemporaryFolder folder;
  std::string socket = folder / "control";
  Watch watch{socket};
  GuardedProgram controller;
  explicit Rig(const std::string& description, const std::vector<std::string>& more)
      : controller(
            folder,
            [&] {
              std::vector<std::string> words{"--rig",       folder.write("rig.toml", description),
                                             "--simulated", "--no-realtime",
                                             "--socket",    socket,
                                             "--out",       folder / "run.csv",
                                             "--publish",   watch.publish_to()};
              words.insert(words.end(), more.begin(), more.end());
              return words;
            }(),
            {}, RIG_CONTROLLER_PROGRAM) {}
};

// A run led from the page: every step is one that the socket demands, and a request in another state is refused.
TEST(Watch, ShowsARunAndPassesItsRequestsOn) {
  Rig rig(patient(support::quarter_car_text), {"--wait", "--duration", "600"});
  const json idle = rig.watch.until_state("idle");
  ASSERT_FALSE(idle.is_null());
  EXPECT_EQ(idle["reason"], "none");
  EXPECT_FALSE(rig.watch.ask("start")["ok"].get<bool>()) << "not without arming";
  EXPECT_TRUE(rig.watch.ask("arm")["ok"].get<bool>());
  ASSERT_FALSE(rig.watch.until_state("armed").is_null());
  EXPECT_TRUE(rig.watch.ask("start")["ok"].get<bool>());
  std::size_t intervals = 0;
  double lowest = 0.0, highest = 0.0;
  const json running = rig.watch.until([&](const json& event) {
    if (!event["traces"].contains("low") || event["state"] != "running") return false;
    intervals += event["traces"]["i"].size();
    const json& low = event["traces"]["low"]["zdd_b"];
    const json& high = event["traces"]["high"]["zdd_b"];
    for (std::size_t i = 0; i < low.size(); ++i) {
      if (low[i].is_null()) continue;
      EXPECT_LE(low[i].get<double>(), high[i].get<double>());
      lowest = std::min(lowest, low[i].get<double>());
      highest = std::max(highest, high[i].get<double>());
    }
    return intervals > 100 && highest > lowest;  // the trace moves
  });
  ASSERT_FALSE(running.is_null());
  EXPECT_TRUE(rig.watch.ask("stop")["ok"].get<bool>());
  const json safe = rig.watch.until_state("safe");
  ASSERT_FALSE(safe.is_null());
  EXPECT_EQ(safe["trip"], "stop_requested");
  ::kill(rig.controller.id(), SIGTERM);
  EXPECT_EQ(rig.controller.wait().status, 0);
  const json ended = rig.watch.until([](const json& event) { return event["link"] == "ended"; });
  ASSERT_FALSE(ended.is_null());
  EXPECT_FALSE(ended["ended"].get<std::string>().empty());
  EXPECT_EQ(rig.watch.end().status, 0);
}

TEST(Watch, ShowsATripWithItsReason) {
  Rig rig(patient(std::string(support::hil_text) + "[limits]\nspeed = 1.5\nenergy_gain = 0.3\n"),
          {"--wait", "--duration", "600"});
  ASSERT_FALSE(rig.watch.until_state("idle").is_null());
  EXPECT_TRUE(rig.watch.ask("arm")["ok"].get<bool>());
  ASSERT_FALSE(rig.watch.until_state("armed").is_null());
  EXPECT_TRUE(rig.watch.ask("start")["ok"].get<bool>());
  const json safe = rig.watch.until_state("safe");
  ASSERT_FALSE(safe.is_null());
  EXPECT_EQ(safe["reason"], "energy");
  EXPECT_THAT(safe["trip"].get<std::string>(), HasSubstr("energy ("));
  ::kill(rig.controller.id(), SIGTERM);
  static_cast<void>(rig.controller.wait());
}

// The cable is out: the controller dies without a word.
TEST(Watch, NoticesThatThePublisherIsGone) {
  Rig rig(patient(support::quarter_car_text), {"--wait", "--duration", "600"});
  ASSERT_FALSE(rig.watch.until_state("idle").is_null());
  ::kill(rig.controller.id(), SIGKILL);
  static_cast<void>(rig.controller.wait());
  const json gone = rig.watch.until([](const json& event) { return event["link"] == "gone"; });
  ASSERT_FALSE(gone.is_null());
  EXPECT_EQ(gone["state"], "idle") << "the last values stay";
  EXPECT_GT(gone["silence"].get<double>(), 1.0);
}

TEST(Watch, RefusesWhatDoesNotFitInOneLine) {
  const TemporaryFolder folder;
  for (const auto& [options, says] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--address", "0.0.0.0"}, "one address of this machine in numbers"},
           {{"--address", "example.org"}, "one address of this machine in numbers"},
           {{"--port", "65536"}, "--port"},
           {{"--receive", "rig.example:9870"}, "the host 'rig.example' is neither localhost nor"},
           {{"--receive", "localhost:x"}, "expected HOST:PORT or PORT"},
           {{"--receive", "::1:9870"}, "an IPv6 address stands in brackets"},
           {{"--address", "192.0.2.1", "--receive", "127.0.0.1:0"}, "cannot be listened at"}}) {
    std::vector<std::string> words{"watch"};
    words.insert(words.end(), options.begin(), options.end());
    const Ended ended = support::rigtwin(words);
    EXPECT_EQ(ended.status, 2) << says;
    EXPECT_THAT(ended.errors, HasSubstr(says));
    EXPECT_EQ(ended.error_lines(), 1);
  }
  EXPECT_EQ(support::rigtwin({"watch", "--rig", "missing.toml"}).status, 3);
}

// For a script that starts the page: its address alone on standard output, at which the page is.
TEST(WatchCommand, SaysAsJsonWhereThePageIs) {
  const TemporaryFolder folder;
  GuardedProgram program(folder,
                         {"watch", "--port", "0", "--receive", "127.0.0.1:0", "--socket", "/no/socket", "--json", "-"});
  const auto until = std::chrono::steady_clock::now() + hang;
  json started = json::value_t::discarded;
  while (program.running() && std::chrono::steady_clock::now() < until && started.is_discarded()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    started = json::parse(TemporaryFolder::read(folder / "stdout.txt"), nullptr, false);
  }
  ASSERT_TRUE(started.is_object());
  EXPECT_EQ(started["requests_to"], "/no/socket");
  EXPECT_THAT(started["values_from"].get<std::string>(), testing::StartsWith("127.0.0.1:"));
  const std::string url = started["url"];
  int port = 0;
  char path[64] = "";
  ASSERT_EQ(std::sscanf(url.c_str(), "http://localhost:%d%63s", &port, path), 2) << url;
  const auto page = httplib::Client("127.0.0.1", port).Get(path);
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  ::kill(program.id(), SIGTERM);
  EXPECT_EQ(program.wait().status, 0);
}

}  // namespace
