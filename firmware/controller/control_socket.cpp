#include "firmware/controller/control_socket.hpp"

#include <grp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/json_text.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/loop/reference_player.hpp"

namespace firmware::controller {
namespace {

constexpr std::size_t most_clients = 8;
constexpr std::size_t longest_request = 1024;
constexpr int answer_patience = 50;  // calls of serve(), 10 ms each

/// A command and the states in which it does something.
struct Command {
  std::string_view word;
  std::string_view states;  ///< empty: any
};
constexpr std::array commands{Command{"state", ""},       Command{"arm", "idle"},
                              Command{"disarm", "armed"}, Command{"start", "armed"},
                              Command{"hold", "running"}, Command{"resume", "holding"},
                              Command{"stop", ""},        Command{"acknowledge", "safe"},
                              Command{"rest", "safe"},    Command{"level", ""},
                              Command{"mark", ""}};

const Command* find_command(std::string_view word) {
  const auto* const found =
      std::find_if(commands.begin(), commands.end(), [&](const Command& c) { return c.word == word; });
  return found == commands.end() ? nullptr : found;
}

bool fits_address(const std::string& path) { return path.size() < sizeof(sockaddr_un::sun_path); }

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  return address;
}

int connect_to(const std::string& path) {
  const sockaddr_un address = address_of(path);
  const int connection = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connection < 0) return -1;
  if (::connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return connection;
  const int error = errno;
  ::close(connection);
  errno = error;
  return -1;
}

}  // namespace

bool is_command(std::string_view word) { return find_command(word) != nullptr; }

ControlSocket::~ControlSocket() {
  for (const Client& client : clients_) ::close(client.socket);
  if (socket_ < 0) return;
  ::close(socket_);
  ::unlink(path_.c_str());
}

std::string ControlSocket::listen(const std::string& path) {
  if (!fits_address(path)) return path + ": the name of a socket has at most 107 bytes";
  const int other = connect_to(path);
  if (other >= 0) {
    ::close(other);
    return path + ": another rig_controller listens there, expected another --socket";
  }
  if (errno == ECONNREFUSED) ::unlink(path.c_str());  // of a program that has died
  const sockaddr_un address = address_of(path);
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const mode_t before = ::umask(0117);
  const bool bound = socket_ >= 0 && ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  const int error = errno;
  ::umask(before);
  if (!bound || ::listen(socket_, static_cast<int>(most_clients)) != 0) {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    return path + ": " + std::strerror(error) + ", expected a place for the control socket (--socket)";
  }
  path_ = path;
  const group* rig = ::getgrnam("rig");
  // Not of that group: only this user connects.
  if (rig != nullptr) static_cast<void>(::chown(path.c_str(), static_cast<uid_t>(-1), rig->gr_gid) != 0);
  return {};
}

void ControlSocket::serve() {
  if (socket_ < 0) return;
  const int connection = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (connection >= 0 && clients_.size() < most_clients) {
    clients_.push_back({});
    clients_.back().socket = connection;
  } else if (connection >= 0) {
    ::close(connection);
  }
  for (std::size_t i = 0; i < clients_.size();) {
    if (serve(clients_[i])) {
      ++i;
      continue;
    }
    ::close(clients_[i].socket);
    clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

/// False: the client is gone, or does not read its answers.
bool ControlSocket::serve(Client& client) {
  if (!client.request.empty()) {
    if (progress_.periods.load() < client.answer_at && --client.patience > 0) return true;
    const std::string line = answer(client) + "\n";
    client.request.clear();
    if (::send(client.socket, line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size()))
      return false;
  }
  const std::size_t end = client.received.find('\n');
  if (end != std::string::npos) {
    const std::string line = client.received.substr(0, end);
    client.received.erase(0, end + 1);
    take(client, line);
    return true;
  }
  std::array<char, longest_request> bytes;
  const ssize_t got = ::recv(client.socket, bytes.data(), bytes.size(), 0);
  if (got > 0) client.received.append(bytes.data(), static_cast<std::size_t>(got));
  if (client.received.size() > longest_request) return false;
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

void ControlSocket::take(Client& client, const std::string& line) {
  const std::size_t blank = line.find(' ');
  const std::string word = line.substr(0, blank);
  client.request = word.empty() ? "?" : word;
  client.trouble = ask(word, blank == std::string::npos ? std::string() : line.substr(blank + 1));
  client.answer_at = progress_.periods.load() + 2;
  client.patience = answer_patience;
}

/// Passes a request on. What is wrong with it, else nothing.
std::string ControlSocket::ask(const std::string& word, const std::string& rest) {
  const Command* command = find_command(word);
  if (command == nullptr) return "unknown command " + in_quotes(word);
  const std::string_view mode = name(progress_.mode.load());
  if (!command->states.empty() && mode != command->states) {
    return word + " needs state " + std::string(command->states) + ", the rig is " + std::string(mode);
  }
  if (word == "rest" && (loses_power(progress_.reason.load()) || loses_power(progress_.second.load()))) {
    return "rest needs a rig that has kept its power; acknowledge and arm it anew";
  }
  if (word == "arm") loop_.arm();
  if (word == "disarm") loop_.disarm();
  if (word == "start") loop_.start();
  if (word == "hold") loop_.hold();
  if (word == "resume") loop_.resume();
  if (word == "stop") loop_.stop();
  if (word == "acknowledge") loop_.acknowledge();
  if (word == "rest") loop_.go_to_rest();
  if (word == "mark") recording_.mark(rest);
  if (word == "level") {
    double level = -1.0;
    const auto read = std::from_chars(rest.data(), rest.data() + rest.size(), level);
    const bool whole = read.ec == std::errc() && read.ptr == rest.data() + rest.size();
    if (!whole || level > highest_level_ || !loop_.level(level)) {
      const bool limited = highest_level_ < ReferencePlayer::highest_level;
      return "level " + in_quotes(rest) + " does not fit, expected 0 to " + shortest(highest_level_) +
             (limited ? ": beyond it this run does not fit the limits" : "");
    }
  }
  if (word != "state" && word != "mark") recording_.mark("operator: " + word + (rest.empty() ? "" : " " + rest));
  return {};
}

std::string ControlSocket::answer(const Client& client) const {
  const auto truth = [](bool value) { return value ? "true" : "false"; };
  std::array<char, 64> position{};
  std::snprintf(position.data(), position.size(), "%.9g", progress_.position.load());
  std::string json =
      std::string("{\"ok\": ") + truth(client.trouble.empty()) + ", \"command\": " + json_text(client.request);
  if (!client.trouble.empty()) json += ", \"error\": " + json_text(client.trouble);
  json += ", \"state\": " + json_text(name(progress_.mode.load())) +
          ", \"reason\": " + json_text(name(progress_.reason.load())) +
          ", \"second_reason\": " + json_text(name(progress_.second.load())) +
          ", \"enabled\": " + truth(progress_.enabled.load()) + ", \"at_rest\": " + truth(progress_.at_rest.load()) +
          ", \"held\": " + truth(progress_.held.load()) + ", \"command_m\": " + position.data() +
          ", \"periods\": " + std::to_string(progress_.periods.load());
  if (publisher_ != nullptr) {
    json += ", \"published\": " + std::to_string(publisher_->sent()) +
            ", \"publish_lost\": " + std::to_string(publisher_->lost());
  }
  return json + "}";
}

std::string socket_path(const std::string& asked, const std::string& described) {
  if (!asked.empty()) return asked;
  return described.empty() ? std::string(usual_socket) : described;
}

int ask_controller(const std::string& path, const std::string& line) {
  if (!is_command(line.substr(0, line.find(' ')))) {
    std::fprintf(stderr, "rig_controller: unknown command %s, see rig_controller --help\n", in_quotes(line).c_str());
    return 2;
  }
  const int connection = fits_address(path) ? connect_to(path) : -1;
  if (connection < 0) {
    std::fprintf(stderr, "rig_controller: %s: no program listens there (%s)\n", path.c_str(), std::strerror(errno));
    return 6;
  }
  const std::string request = one_line(line) + "\n";
  std::string reply;
  bool sent = ::send(connection, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size());
  pollfd readable{connection, POLLIN, 0};
  while (sent && reply.find('\n') == std::string::npos) {
    std::array<char, 1024> bytes;
    sent = ::poll(&readable, 1, 5000) == 1;
    const ssize_t got = sent ? ::recv(connection, bytes.data(), bytes.size(), 0) : 0;
    if (got <= 0) break;
    reply.append(bytes.data(), static_cast<std::size_t>(got));
  }
  ::close(connection);
  if (reply.empty()) {
    std::fprintf(stderr, "rig_controller: %s: no answer\n", path.c_str());
    return 6;
  }
  std::fputs(reply.c_str(), stdout);
  return reply.find("\"ok\": true") != std::string::npos ? 0 : 6;
}

}  // namespace firmware::controller
