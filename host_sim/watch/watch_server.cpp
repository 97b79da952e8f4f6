#include "host_sim/watch/watch_server.hpp"

#include <httplib.h>
#include <poll.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/watch/access.hpp"
#include "host_sim/watch/controller_client.hpp"
#include "host_sim/watch/front_door.hpp"
#include "host_sim/watch/watch_page.hpp"

namespace host_sim::watch {
namespace {

constexpr int most_watchers = 8;
constexpr std::size_t server_threads = 24;  // each watcher keeps one; a request to stop has its own (FrontDoor)
constexpr std::chrono::milliseconds frame_pause{40};
constexpr int frames_without_news = 12;  // of frame_pause: a page that hears nothing for longer has lost the server
constexpr std::chrono::milliseconds instance_pause{1000};  // between two looks at who answers the requests

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(why + "\n", "text/plain; charset=utf-8");
}

std::string dumped(const nlohmann::json& object) {
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A connection whose request has been read: httplib reads it from memory and writes its answer.
class ReadRequest final : public httplib::Stream {
 public:
  ReadRequest(int socket, const std::string& request) : socket_(socket), request_(request) {}

  [[nodiscard]] bool is_readable() const override { return read_ < request_.size(); }
  /// And still there: a page that was closed gives its place back at once.
  [[nodiscard]] bool is_writable() const override {
    pollfd writable{socket_, POLLOUT, 0};
    char byte = 0;
    return ::poll(&writable, 1, write_patience_ms) == 1 && (writable.revents & (POLLERR | POLLHUP)) == 0 &&
           ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) != 0;
  }
  ssize_t read(char* bytes, size_t size) override {
    const std::size_t given = std::min(size, request_.size() - read_);
    std::copy_n(request_.data() + read_, given, bytes);
    read_ += given;
    return static_cast<ssize_t>(given);
  }
  ssize_t write(const char* bytes, size_t size) override {
    std::size_t sent = 0;
    while (sent < size) {
      pollfd writable{socket_, POLLOUT, 0};
      if (::poll(&writable, 1, write_patience_ms) != 1) return -1;
      const ssize_t now = ::send(socket_, bytes + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (now <= 0) return -1;
      sent += static_cast<std::size_t>(now);
    }
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { name(ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override { name(ip, port); }
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  static constexpr int write_patience_ms = 2000;
  static void name(std::string& ip, int& port) {  // nobody asks
    ip.clear();
    port = 0;
  }

  int socket_;
  const std::string& request_;
  std::size_t read_ = 0;
};

/// httplib's routes and answers, without its sockets and threads.
class Routes final : public httplib::Server {
 public:
  void answer(int socket, const std::string& request) {
    ReadRequest stream(socket, request);
    bool closed = false;
    static_cast<void>(process_request(stream, /*close_connection=*/true, closed, nullptr));
  }
  /// A stream of events goes on while the server listens.
  void listens_at(int socket) { svr_sock_ = socket; }
  void ends() { svr_sock_ = INVALID_SOCKET; }
};

/// The instance in an answer of the controller; empty: none.
std::string instance_of(const Answer& answer) {
  if (!answer.heard) return {};
  const auto json = nlohmann::json::parse(answer.text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("instance") || !json["instance"].is_string()) return {};
  return json["instance"].get<std::string>();
}

}  // namespace

class WatchServer::Implementation {
 public:
  Implementation(const Setup& setup, const Feed& feed) : setup_(setup), feed_(feed), token_(random_token()) {
    server_.set_payload_max_length(FrontDoor::longest_body);
    server_.set_default_headers({{"Cache-Control", "no-store"},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"X-Frame-Options", "DENY"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"}});
    add_routes();
    door_ = std::make_unique<FrontDoor>(setup_.address, setup_.port, server_threads,
                                        [this](int socket, const std::string& request) {
                                          listening_.wait(false);
                                          server_.answer(socket, request);
                                        });
    port_ = door_->port();
    server_.listens_at(door_->socket());
    listening_.store(true);
    listening_.notify_all();
    thread_ = std::thread([this] { look_for_the_controller(); });
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  ~Implementation() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      end_ = true;
    }
    ended_.notify_all();
    server_.ends();
    door_.reset();
    thread_.join();
  }

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] const std::string& token() const { return token_; }
  [[nodiscard]] const Setup& setup() const { return setup_; }

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  void add_routes() {
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
      if (request.get_header_value_count("Host") == 1 &&
          is_own_host(request.get_header_value("Host"), setup_.address, port_)) {
        return httplib::Server::HandlerResponse::Unhandled;
      }
      refuse(response, 421, "this server has another name");
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.Get("/", [this](const Request& request, Response& response) { send_page(request, response); });
    server_.Get("/events", [this](const Request& request, Response& response) { send_events(request, response); });
    server_.Post("/ask", [this](const Request& request, Response& response) { ask(request, response); });
  }

  /// While somebody watches: which program answers the requests.
  void look_for_the_controller() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, instance_pause, [this] { return end_; })) {
      if (watchers_.load() == 0) continue;
      lock.unlock();
      std::string instance = instance_of(ask_controller(setup_.socket, "state"));
      lock.lock();
      controller_ = std::move(instance);
    }
  }

  [[nodiscard]] bool knows_token(const Request& request) const {
    return equal_in_constant_time(request.get_param_value("token"), token_);
  }

  void send_page(const Request& request, Response& response) const {
    if (!knows_token(request)) {
      refuse(response, 403, "The token is missing or wrong: open the address that rigtwin watch has printed.");
      return;
    }
    const std::string nonce = random_token();
    response.set_header("Content-Security-Policy", watch_page_policy(nonce));
    response.set_content(watch_page(nonce), "text/html; charset=utf-8");
  }

  void send_events(const Request& request, Response& response) {
    if (!knows_token(request)) {
      refuse(response, 403, "the token is missing or wrong");
      return;
    }
    if (watchers_.fetch_add(1) >= most_watchers) {
      watchers_.fetch_sub(1);
      refuse(response, 503, "eight pages watch already");
      return;
    }
    auto cursor = std::make_shared<Feed::Cursor>();
    response.set_chunked_content_provider(
        "text/event-stream", [this, cursor](std::size_t, httplib::DataSink& sink) { return send_frame(*cursor, sink); },
        [this](bool) { watchers_.fetch_sub(1); });
  }

  /// The next frame, once it is due. False: the page or the server is gone.
  bool send_frame(Feed::Cursor& cursor, httplib::DataSink& sink) {
    for (int pauses = cursor.history == 0 ? frames_without_news : 0; pauses < frames_without_news; ++pauses) {
      std::unique_lock<std::mutex> lock(mutex_);
      if (ended_.wait_for(lock, frame_pause, [this] { return end_; })) return false;
      lock.unlock();
      if (!sink.is_writable()) return false;  // a page that was closed gives its place back at once
      if (feed_.has_news(cursor)) break;
    }
    nlohmann::json frame = feed_.frame(cursor, steady_seconds());
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      frame["controller"] = controller_;
    }
    const std::string event = "data: " + dumped(frame) + "\n\n";
    return sink.write(event.data(), event.size());
  }

  void ask(const Request& request, Response& response) const {
    if (!equal_in_constant_time(request.get_header_value("X-Rigtwin-Token"), token_)) {
      refuse(response, 403, "the token is missing or wrong");
      return;
    }
    if (request.has_header("Origin") && !is_own_origin(request.get_header_value("Origin"), setup_.address, port_)) {
      refuse(response, 403, "this request comes from another page");
      return;
    }
    if (const std::string objection = request_objection(request.body); !objection.empty()) {
      refuse(response, 400, objection);
      return;
    }
    // The values on the page are one program's; what moves a rig is meant for that one. A stop is for whoever listens.
    const std::string shown = request.body == "stop" || request.body == "state" ? "" : feed_.instance();
    const Answer answer = ask_controller(setup_.socket, (shown.empty() ? "" : "@" + shown + " ") + request.body);
    response.set_content(dumped({{"heard", answer.heard}, {"answer", answer.text}}), "application/json");
  }

  Setup setup_;
  const Feed& feed_;
  std::string token_;
  Routes server_;
  std::unique_ptr<FrontDoor> door_;
  std::atomic<bool> listening_{false};
  int port_ = -1;
  std::atomic<int> watchers_{0};
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::string controller_;  ///< instance that answers the requests; empty: none, or not known yet
  std::thread thread_;
};

WatchServer::WatchServer(const Setup& setup, const Feed& feed)
    : implementation_(std::make_unique<Implementation>(setup, feed)) {}

WatchServer::~WatchServer() = default;

int WatchServer::port() const { return implementation_->port(); }

const std::string& WatchServer::token() const { return implementation_->token(); }

std::string WatchServer::url() const {
  const std::string& address = implementation_->setup().address;
  const std::string host = is_loopback(address) && address.find(':') == std::string::npos ? "localhost"
                           : address.find(':') != std::string::npos                       ? "[" + address + "]"
                                                                                          : address;
  return "http://" + host + ":" + std::to_string(port()) + "/?token=" + token();
}

}  // namespace host_sim::watch
