#include "host_sim/watch/controller_client.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>

#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/reference/reference_player.hpp"

namespace host_sim::watch {
namespace {

constexpr std::array<std::string_view, 9> words_alone{"state",  "arm",  "disarm",      "start", "hold",
                                                      "resume", "stop", "acknowledge", "rest"};
constexpr std::size_t longest_mark = 200;
constexpr std::size_t longest_answer = 4096;
constexpr std::chrono::milliseconds answer_patience{2000};  // the socket itself answers within 0.5 s

bool is_level(std::string_view text) {
  double level = -1.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), level);
  return read.ec == std::errc() && read.ptr == text.data() + text.size() && level >= 0.0 &&
         level <= firmware::ReferencePlayer::highest_level;
}

bool is_mark(std::string_view text) {
  return !text.empty() && text.size() <= longest_mark && firmware::one_line(text) == text;
}

/// A socket that is closed at the end.
class Connection {
 public:
  Connection() : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    if (socket_ >= 0) ::close(socket_);
  }
  [[nodiscard]] int number() const { return socket_; }

 private:
  int socket_;
};

bool connect_to(int socket, const std::string& path) {
  sockaddr_un address{};
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return false;
  }
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  // EAGAIN: so many wait at once that the kernel keeps no more. They are taken up every 10 ms.
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + answer_patience;
  while (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    if (errno != EAGAIN || Clock::now() >= until) return false;
    ::usleep(1000);
  }
  return true;
}

/// The first line that comes; empty: none came in time.
std::string read_line(int socket) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + answer_patience;
  std::string text;
  while (text.find('\n') == std::string::npos && text.size() < longest_answer) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd readable{socket, POLLIN, 0};
    if (left <= 0 || ::poll(&readable, 1, static_cast<int>(left)) != 1) return {};
    std::array<char, 1024> bytes{};
    const ssize_t got = ::recv(socket, bytes.data(), bytes.size(), 0);
    if (got <= 0) return {};
    text.append(bytes.data(), static_cast<std::size_t>(got));
  }
  return text.substr(0, text.find('\n'));
}

}  // namespace

std::string request_objection(std::string_view request) {
  if (std::find(words_alone.begin(), words_alone.end(), request) != words_alone.end()) return {};
  if (request.starts_with("level ")) {
    return is_level(request.substr(6)) ? "" : "this level does not fit, expected a number from 0 to 1.5";
  }
  if (request.starts_with("mark ")) {
    return is_mark(request.substr(5)) ? "" : "this mark does not fit, expected one line of at most 200 bytes";
  }
  return "unknown request " + firmware::in_quotes(request);
}

Answer ask_controller(const std::string& path, std::string_view request) {
  const Connection connection;
  if (connection.number() < 0 || !connect_to(connection.number(), path)) {
    return {false, path + ": no controller listens there (" + std::strerror(errno) + ")"};
  }
  const std::string line = std::string(request) + "\n";
  if (::send(connection.number(), line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size())) {
    return {false, path + ": the controller does not take requests (" + std::strerror(errno) + ")"};
  }
  const std::string reply = read_line(connection.number());
  if (reply.empty()) return {false, path + ": no answer; whether the controller has taken the request is unknown"};
  return {true, reply};
}

}  // namespace host_sim::watch
