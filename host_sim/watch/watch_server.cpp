#include "host_sim/watch/watch_server.hpp"

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/watch/access.hpp"
#include "host_sim/watch/controller_client.hpp"
#include "host_sim/watch/watch_page.hpp"

namespace host_sim::watch {
namespace {

constexpr int most_watchers = 8;
// Each watcher keeps a thread; the others are for requests, above all to stop.
constexpr std::size_t server_threads = 24;
constexpr std::chrono::milliseconds frame_pause{40};
constexpr int frames_without_news = 12;  // of frame_pause: a page that hears nothing for longer has lost the server
constexpr std::size_t longest_request_body = 1024;

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

}  // namespace

class WatchServer::Implementation {
 public:
  Implementation(const Setup& setup, const Feed& feed) : setup_(setup), feed_(feed), token_(random_token()) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(server_threads); };
    server_.set_payload_max_length(longest_request_body);
    server_.set_keep_alive_timeout(2);
    server_.set_read_timeout(2);
    server_.set_write_timeout(2);
    // Only this server listens at the port: httplib shares it with whoever asks unless told otherwise.
    server_.set_socket_options([](auto socket) {
      const int yes = 1;
      static_cast<void>(::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes));
    });
    server_.set_default_headers({{"Cache-Control", "no-store"},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"X-Frame-Options", "DENY"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"}});
    add_routes();
    listen();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  ~Implementation() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      end_ = true;
    }
    ended_.notify_all();
    server_.stop();
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

  void listen() {
    if (setup_.port == 0) {
      port_ = server_.bind_to_any_port(setup_.address);
    } else {
      port_ = server_.bind_to_port(setup_.address, setup_.port) ? setup_.port : -1;
    }
    if (port_ < 0) {
      throw firmware::UsageError(setup_.address + ":" + std::to_string(setup_.port) +
                                 " cannot be listened at, expected an address of this machine and a free --port");
    }
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
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
    const std::string event = "data: " + dumped(feed_.frame(cursor, steady_seconds())) + "\n\n";
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
    const Answer answer = ask_controller(setup_.socket, request.body);
    response.set_content(dumped({{"heard", answer.heard}, {"answer", answer.text}}), "application/json");
  }

  Setup setup_;
  const Feed& feed_;
  std::string token_;
  httplib::Server server_;
  int port_ = -1;
  std::atomic<int> watchers_{0};
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
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
