#include "host_sim/watch/watch_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/watch/controller_client.hpp"
#include "host_sim/watch/front_door.hpp"
#include "tests/support/temporary_folder.hpp"

// Last: it defines _res as a macro, a name that Eigen uses.
#include <httplib.h>

namespace {

using host_sim::watch::Feed;
using host_sim::watch::WatchServer;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

/// In place of a controller: answers each line with its echo, and keeps what it was asked.
class FakeController {
 public:
  explicit FakeController(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), address.sun_path);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(socket_, 8), 0);
    thread_ = std::thread([this] { serve(); });
  }
  FakeController(const FakeController&) = delete;
  FakeController& operator=(const FakeController&) = delete;
  ~FakeController() {
    ::shutdown(socket_, SHUT_RDWR);
    thread_.join();
    ::close(socket_);
  }
  std::vector<std::string> asked;  ///< read it once the answer is there

 private:
  void serve() {
    for (;;) {
      const int client = ::accept(socket_, nullptr, nullptr);
      if (client < 0) return;
      char bytes[1024];
      const ssize_t got = ::recv(client, bytes, sizeof bytes, 0);
      if (got > 0) {
        asked.emplace_back(bytes, static_cast<std::size_t>(got) - 1);
        const std::string answer = R"({"ok": true, "state": "idle"})"
                                   "\n";
        EXPECT_EQ(::send(client, answer.data(), answer.size(), MSG_NOSIGNAL), static_cast<ssize_t>(answer.size()));
      }
      ::close(client);
    }
  }
  int socket_;
  std::thread thread_;
};

struct Served : testing::Test {
  support::TemporaryFolder folder;
  std::string socket = folder / "control";
  Feed feed;
  WatchServer server{{"127.0.0.1", 0, socket}, feed};
  httplib::Client client{"127.0.0.1", server.port()};

  [[nodiscard]] std::string with_token(const std::string& path) const { return path + "?token=" + server.token(); }
  [[nodiscard]] httplib::Headers as_page() const { return {{"X-Rigtwin-Token", server.token()}}; }
  httplib::Result ask(const std::string& request, const httplib::Headers& headers) {
    return client.Post("/ask", headers, request, "text/plain");
  }
};

TEST_F(Served, GivesItsPageToWhoHasTheToken) {
  EXPECT_EQ(server.url(), "http://localhost:" + std::to_string(server.port()) + "/?token=" + server.token());
  const auto page = client.Get(with_token("/"));
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->body, AllOf(HasSubstr("<title>rigtwin watch</title>"), HasSubstr("EventSource")));
  EXPECT_EQ(page->body.find("@script"), std::string::npos) << "every place is filled";
  for (const char* path : {"/", "/?token=", "/?token=0123", "/events", "/events?token=x"}) {
    const auto refused = client.Get(path);
    ASSERT_TRUE(refused) << path;
    EXPECT_EQ(refused->status, 403) << path;
    EXPECT_EQ(refused->body.find("EventSource"), std::string::npos);
  }
  EXPECT_EQ(client.Get(with_token("/etc/passwd"))->status, 404);
}

// The page runs its own script and style and nothing else, even if a name or a mark held markup.
TEST_F(Served, SendsAPolicyThatLetsInNothingElse) {
  const auto page = client.Get(with_token("/"));
  ASSERT_TRUE(page);
  const std::string policy = page->get_header_value("Content-Security-Policy");
  EXPECT_THAT(policy, AllOf(HasSubstr("default-src 'none'"), HasSubstr("connect-src 'self'"),
                            HasSubstr("frame-ancestors 'none'"), HasSubstr("base-uri 'none'")));
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
  const std::size_t at = policy.find("'nonce-") + 7;
  const std::string nonce = policy.substr(at, policy.find('\'', at) - at);
  EXPECT_EQ(nonce.size(), 32U);
  EXPECT_THAT(page->body,
              AllOf(HasSubstr("<script nonce=\"" + nonce + "\">"), HasSubstr("<style nonce=\"" + nonce + "\">")));
  EXPECT_EQ(page->body.find("src="), std::string::npos);
  EXPECT_EQ(client.Get(with_token("/"))->body.find(nonce), std::string::npos) << "a nonce is used once";
  EXPECT_EQ(page->get_header_value("Cache-Control"), "no-store");
  EXPECT_EQ(page->get_header_value("Referrer-Policy"), "no-referrer") << "the token stands in the address";
}

// A page from elsewhere whose name was led to this machine comes with that name, and would know the token of a server
// that it talked to; nothing is served under it.
TEST_F(Served, ServesUnderItsOwnNameOnly) {
  const std::string port = ":" + std::to_string(server.port());
  for (const std::string& host : {std::string("evil.example") + port, std::string("evil.example"),
                                  std::string("127.0.0.1:1"), std::string("localhost.evil.example") + port}) {
    const auto refused = client.Get(with_token("/"), {{"Host", host}});
    ASSERT_TRUE(refused) << host;
    EXPECT_EQ(refused->status, 421) << host;
    httplib::Headers headers = as_page();
    headers.emplace("Host", host);
    EXPECT_EQ(ask("state", headers)->status, 421) << host;
  }
  EXPECT_EQ(client.Get(with_token("/"), {{"Host", "localhost" + port}})->status, 200);
}

TEST_F(Served, PassesRequestsOnAndAnswersForTheController) {
  FakeController controller(socket);
  for (const char* request : {"state", "arm", "start", "hold", "resume", "stop", "acknowledge", "rest", "disarm",
                              "level 0.8", "mark a knock, left"}) {
    const auto reply = ask(request, as_page());
    ASSERT_TRUE(reply) << request;
    ASSERT_EQ(reply->status, 200) << request << ": " << reply->body;
    const json answer = json::parse(reply->body);
    EXPECT_TRUE(answer["heard"].get<bool>());
    EXPECT_TRUE(json::parse(answer["answer"].get<std::string>())["ok"].get<bool>());
    EXPECT_EQ(controller.asked.back(), request);
  }
}

// Nothing reaches the socket that the socket's own client would not send, and nothing without the token: a form of
// another page cannot set the header.
TEST_F(Served, PassesNothingElseOn) {
  FakeController controller(socket);
  for (const char* request : {"", "jump", "arm now", "stop\nstart", "level", "level x", "level 1.6", "level -1",
                              "level nan", "level 1 1", "mark", "mark ", "mark a\nstart", "Arm", " arm"}) {
    EXPECT_EQ(ask(request, as_page())->status, 400) << request;
  }
  EXPECT_EQ(ask("mark " + std::string(201, 'x'), as_page())->status, 400);
  EXPECT_EQ(ask("state", {})->status, 403);
  EXPECT_EQ(ask("state", {{"X-Rigtwin-Token", "0"}})->status, 403);
  EXPECT_EQ(client.Post("/ask?token=" + server.token(), "state", "text/plain")->status, 403) << "a form could do that";
  httplib::Headers foreign = as_page();
  foreign.emplace("Origin", "http://evil.example");
  EXPECT_EQ(ask("state", foreign)->status, 403);
  EXPECT_NE(client.Get("/ask")->status, 200);
  EXPECT_TRUE(controller.asked.empty());
  httplib::Headers own = as_page();
  own.emplace("Origin", "http://localhost:" + std::to_string(server.port()));
  EXPECT_EQ(ask("state", own)->status, 200);
}

TEST_F(Served, SaysThatNoControllerListens) {
  const auto reply = ask("stop", as_page());
  ASSERT_TRUE(reply);
  const json answer = json::parse(reply->body);
  EXPECT_FALSE(answer["heard"].get<bool>());
  EXPECT_THAT(answer["answer"].get<std::string>(), HasSubstr("no controller listens there"));
}

// What moves a rig is meant for the rig that the page shows: the request says so, and another program refuses it. A
// stop is for whoever listens.
TEST_F(Served, AsksTheProgramWhoseValuesItShows) {
  FakeController controller(socket);
  feed.take(R"({"timestamp":1,"sequence":0,"lost":0,"state":"idle","instance":"aa.1@here"})", "127.0.0.1:5", 0.0, 0);
  EXPECT_EQ(ask("arm", as_page())->status, 200);
  EXPECT_EQ(controller.asked.back(), "@aa.1@here arm");
  EXPECT_EQ(ask("stop", as_page())->status, 200);
  EXPECT_EQ(controller.asked.back(), "stop");
}

// Fault. Strangers who send their requests byte by byte, without a token, keep nobody from a stop: none of them has a
// thread. (Two dozen of them once had all.)
TEST_F(Served, HearsAStopAmongSlowStrangers) {
  FakeController controller(socket);
  std::atomic<bool> end{false};
  std::thread strangers([&] {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(server.port()));
    std::vector<int> all(60, -1);
    while (!end.load()) {
      for (int& one : all) {
        if (one >= 0 && ::send(one, "x", 1, MSG_NOSIGNAL) == 1) continue;
        if (one >= 0) ::close(one);
        one = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (::connect(one, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) continue;
        static_cast<void>(::send(one, "POST /ask HTTP/1.1\r\nX", 21, MSG_NOSIGNAL));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    for (const int one : all) ::close(one);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto reply = ask("stop", as_page());
  end.store(true);
  strangers.join();
  ASSERT_TRUE(reply) << "nobody had time for it";
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(controller.asked.back(), "stop");
}

TEST(FrontDoor, KnowsAWholeRequestAndAStop) {
  using host_sim::watch::is_stop_request;
  using host_sim::watch::whole_request;
  const std::string head = "POST /ask HTTP/1.1\r\nHost: x\r\ncontent-LENGTH: 4\r\n\r\n";
  EXPECT_EQ(whole_request(head.substr(0, head.size() - 1)), 0U);
  EXPECT_EQ(whole_request(head + "sto"), 0U);
  EXPECT_EQ(whole_request(head + "stop"), head.size() + 4);
  EXPECT_EQ(whole_request(head + "stopped"), head.size() + 4) << "one request a connection";
  EXPECT_TRUE(is_stop_request(head + "stop"));
  EXPECT_FALSE(is_stop_request(head + "star"));
  EXPECT_FALSE(is_stop_request("GET /ask HTTP/1.1\r\n\r\nstop"));
  const std::string vast = "POST /ask HTTP/1.1\r\nContent-Length: 99999\r\n\r\n";
  EXPECT_EQ(whole_request(vast), vast.size()) << "refused unread";
  EXPECT_NE(whole_request(std::string(20'000, 'x')), 0U) << "an endless head is none";
}

/// The first events of a stream.
std::vector<json> events_of(httplib::Client& client, const std::string& path, std::size_t many) {
  std::string text;
  std::vector<json> events;
  static_cast<void>(client.Get(path, [&](const char* data, std::size_t size) {
    text.append(data, size);
    for (std::size_t end = text.find("\n\n"); end != std::string::npos; end = text.find("\n\n")) {
      events.push_back(json::parse(text.substr(6, end - 6)));
      text.erase(0, end + 2);
    }
    return events.size() < many;
  }));
  return events;
}

TEST_F(Served, StreamsEvenWhenNothingComes) {
  const auto events = events_of(client, with_token("/events"), 2);
  ASSERT_GE(events.size(), 2U);
  EXPECT_EQ(events[0]["link"], "waiting");
  EXPECT_TRUE(events[0]["traces"]["reset"].get<bool>());
}

// A watcher that is gone gives its place back; there are eight.
TEST_F(Served, HasEightPlacesForWatchers) {
  for (int i = 0; i < 20; ++i) {
    std::size_t seen = 0;
    for (int attempt = 0; attempt < 200 && seen == 0; ++attempt) {
      httplib::Client one("127.0.0.1", server.port());
      seen = events_of(one, with_token("/events"), 1).size();
      if (seen == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_GE(seen, 1U) << i;
  }
  std::atomic<bool> end{false};
  std::atomic<int> watching{0};
  std::vector<std::thread> watchers;
  for (int i = 0; i < 8; ++i) {
    watchers.emplace_back([&] {
      while (!end.load()) {  // places of the watchers before come back one after the other
        httplib::Client one("127.0.0.1", server.port());
        bool counted = false;
        static_cast<void>(one.Get(
            with_token("/events"), [&](const httplib::Response& response) { return response.status == 200; },
            [&](const char*, std::size_t) {
              if (!counted) watching.fetch_add(1);
              counted = true;
              return !end.load();
            }));
      }
    });
  }
  while (watching.load() < 8) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(client.Get(with_token("/events"))->status, 503);
  EXPECT_EQ(client.Get(with_token("/"))->status, 200) << "there is still somebody for requests";
  EXPECT_EQ(ask("stop", as_page())->status, 200);
  end.store(true);
  for (std::thread& watcher : watchers) watcher.join();
}

TEST(WatchServer, DoesNotShareItsPort) {
  const Feed feed;
  const WatchServer first({"127.0.0.1", 0, "/nowhere"}, feed);
  EXPECT_THROW(WatchServer({"127.0.0.1", first.port(), "/nowhere"}, feed), firmware::UsageError);
}

}  // namespace
