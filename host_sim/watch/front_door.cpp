#include "host_sim/watch/front_door.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <optional>
#include <string_view>
#include <utility>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::watch {
namespace {

constexpr std::int64_t request_patience_ms = 2000;
constexpr int write_patience_s = 2;

std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

bool equal_without_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return lower(x) == lower(y);
  });
}

/// Of the head; 0: none, nullopt: no number.
std::optional<std::size_t> content_length(std::string_view head) {
  constexpr std::string_view name = "content-length:";
  for (std::size_t line = head.find("\r\n"); line != std::string_view::npos; line = head.find("\r\n", line + 2)) {
    std::string_view field = head.substr(line + 2);
    field = field.substr(0, field.find("\r\n"));
    if (field.size() < name.size() || !equal_without_case(field.substr(0, name.size()), name)) continue;
    field.remove_prefix(name.size());
    while (field.starts_with(' ') || field.starts_with('\t')) field.remove_prefix(1);
    std::size_t length = 0;
    const auto read = std::from_chars(field.data(), field.data() + field.size(), length);
    if (read.ec != std::errc() || read.ptr == field.data()) return std::nullopt;
    return length;
  }
  return 0;
}

}  // namespace

std::size_t whole_request(const std::string& bytes) {
  const std::size_t end = bytes.find("\r\n\r\n");
  if (end == std::string::npos) return bytes.size() > FrontDoor::longest_request ? bytes.size() : 0;
  const std::size_t head = end + 4;
  const std::optional<std::size_t> body = content_length(std::string_view(bytes).substr(0, end + 2));
  if (!body || *body > FrontDoor::longest_body) return head;
  return bytes.size() >= head + *body ? head + *body : 0;
}

bool is_stop_request(const std::string& request) {
  if (!request.starts_with("POST /ask ")) return false;
  const std::size_t end = request.find("\r\n\r\n");
  return end != std::string::npos && std::string_view(request).substr(end + 4) == "stop";
}

FrontDoor::FrontDoor(const std::string& address, int port, std::size_t threads, Answer answer)
    : answer_(std::move(answer)) {
  const auto at = firmware::parse_host(address, static_cast<std::uint16_t>(port));
  const int yes = 1;
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  if (at) listening_ = ::socket(at->storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const bool listens = listening_ >= 0 && ::setsockopt(listening_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
                       ::bind(listening_, at->raw(), at->length) == 0 && ::listen(listening_, SOMAXCONN) == 0 &&
                       ::getsockname(listening_, reinterpret_cast<sockaddr*>(&own), &size) == 0;
  if (listens) wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_ < 0) {
    if (listening_ >= 0) ::close(listening_);
    throw firmware::UsageError(address + ":" + std::to_string(port) +
                               " cannot be listened at, expected an address of this machine and a free --port");
  }
  port_ = firmware::internet_address(own, size).port();
  threads_.emplace_back([this] { watch_door(); });
  threads_.emplace_back([this] { answer_all(stops_); });
  for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { answer_all(others_); });
}

FrontDoor::~FrontDoor() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_, &one, sizeof one) < 0);
  stops_.news.notify_all();
  others_.news.notify_all();
  for (std::thread& thread : threads_) thread.join();
  for (const Connection& connection : connections_) ::close(connection.socket);
  for (Queue* queue : {&stops_, &others_}) {
    for (const Request& request : queue->requests) ::close(request.socket);
  }
  ::close(wake_);
  ::close(listening_);
}

void FrontDoor::watch_door() {
  std::vector<pollfd> polled;
  for (;;) {
    polled.assign({{wake_, POLLIN, 0}, {listening_, POLLIN, 0}});
    std::int64_t next = now_ms() + 60'000;
    for (const Connection& connection : connections_) {
      polled.push_back({connection.socket, POLLIN, 0});
      next = std::min(next, connection.until_ms);
    }
    const std::int64_t pause = std::max<std::int64_t>(0, next - now_ms());
    if (::poll(polled.data(), polled.size(), static_cast<int>(pause) + 1) < 0 && errno != EINTR) return;
    if ((polled[0].revents & POLLIN) != 0) return;
    const std::int64_t now = now_ms();
    std::size_t i = 2;
    for (auto connection = connections_.begin(); connection != connections_.end(); ++i) {
      const bool stays = polled[i].revents == 0 ? now < connection->until_ms : read_on(*connection);
      connection = stays ? std::next(connection) : connections_.erase(connection);
    }
    if ((polled[1].revents & POLLIN) != 0) accept_all();
  }
}

/// Most requests are there when their connection is.
void FrontDoor::accept_all() {
  for (std::size_t i = 0; i < most_connections; ++i) {
    const int socket = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (socket < 0) return;
    connections_.push_back({socket, now_ms() + request_patience_ms, {}});
    if (!read_on(connections_.back())) connections_.pop_back();
    if (connections_.size() <= most_connections) continue;
    ::close(connections_.front().socket);
    connections_.pop_front();
  }
}

/// False: the connection is somebody else's now, or closed.
bool FrontDoor::read_on(Connection& connection) {
  std::array<char, 4096> bytes;
  for (;;) {
    const ssize_t got = ::recv(connection.socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      if (now_ms() < connection.until_ms) return true;
      ::close(connection.socket);
      return false;
    }
    if (got <= 0) {
      ::close(connection.socket);
      return false;
    }
    connection.received.append(bytes.data(), static_cast<std::size_t>(got));
    const std::size_t whole = whole_request(connection.received);
    if (whole == 0) continue;
    connection.received.resize(whole);
    hand_on(connection);
    return false;
  }
}

void FrontDoor::hand_on(Connection& connection) {
  // Its thread waits for the connection, but not for ever: what is sent must be taken.
  const timeval patience{write_patience_s, 0};
  const int yes = 1;
  static_cast<void>(::setsockopt(connection.socket, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience));
  static_cast<void>(::setsockopt(connection.socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes));
  Queue& queue = is_stop_request(connection.received) ? stops_ : others_;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (queue.requests.size() < most_waiting) {
      queue.requests.push_back({connection.socket, std::move(connection.received)});
      connection.socket = -1;
    }
  }
  if (connection.socket >= 0) ::close(connection.socket);
  queue.news.notify_one();
}

void FrontDoor::answer_all(Queue& queue) {
  for (;;) {
    std::unique_lock<std::mutex> lock(mutex_);
    queue.news.wait(lock, [&] { return end_ || !queue.requests.empty(); });
    if (end_) return;
    const Request request = std::move(queue.requests.front());
    queue.requests.pop_front();
    lock.unlock();
    answer_(request.socket, request.bytes);
    ::shutdown(request.socket, SHUT_RDWR);
    ::close(request.socket);
  }
}

}  // namespace host_sim::watch
