#include "firmware/controller/control_socket.hpp"

#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/json_text.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/loop/reference/reference_player.hpp"
#include "hal/linux/clock.hpp"

namespace firmware::controller {
namespace {

constexpr std::size_t most_of_a_user = 8, most_clients = 64;
constexpr int waiting_connections = 128;                  // that the kernel keeps between two calls of serve()
constexpr hal::Time silence = hal::milliseconds(10'000);  // a person at a terminal types faster
constexpr std::int64_t clients_patience_ms = 2000;        // of ask_controller(): the longest answer takes 0.5 s
constexpr std::size_t longest_request = 1024;
constexpr int answer_patience = 50;  // calls of serve(), 10 ms each

/// A command and the states in which it does something.
struct Command {
  std::string_view word;
  std::string_view states;  ///< empty: any
  bool with_words = false;  ///< it has something to say behind the word
};
constexpr std::array commands{Command{"state", ""},       Command{"arm", "idle"},         Command{"disarm", "armed"},
                              Command{"start", "armed"},  Command{"hold", "running"},     Command{"resume", "holding"},
                              Command{"stop", ""},        Command{"acknowledge", "safe"}, Command{"rest", "safe"},
                              Command{"level", "", true}, Command{"mark", "", true}};

const Command* find_command(std::string_view word) {
  const auto* const found =
      std::find_if(commands.begin(), commands.end(), [&](const Command& c) { return c.word == word; });
  return found == commands.end() ? nullptr : found;
}

/// Without the carriage return that some clients send, and blanks at the end.
std::string_view without_blank_end(std::string_view line) { return line.substr(0, line.find_last_not_of(" \t\r") + 1); }

std::string_view first_word(std::string_view line) { return line.substr(0, line.find(' ')); }

/// Without the instance that a line begins with.
std::string_view without_instance(std::string_view line) {
  if (!line.starts_with('@')) return line;
  const std::size_t blank = line.find(' ');
  return blank == std::string_view::npos ? std::string_view() : line.substr(blank + 1);
}

bool fits_address(const std::string& path) { return path.size() < sizeof(sockaddr_un::sun_path); }

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  return address;
}

/// −1: errno says why. EAGAIN: a program listens there and does not answer.
int connect_to(const std::string& path) {
  const sockaddr_un address = address_of(path);
  const int connection = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (connection < 0) return -1;
  if (::connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return connection;
  const int error = errno;
  ::close(connection);
  errno = error;
  return -1;
}

/// Of the folder in which a socket lies, while it lives: so that two programs do not take the same name at once.
class FolderLock {
 public:
  explicit FolderLock(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    folder_ = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    // Whoever else locks this folder for long keeps nobody from a rig's socket: after a second it goes on without.
    for (int i = 0; folder_ >= 0 && i < 100 && ::flock(folder_, LOCK_EX | LOCK_NB) != 0; ++i) ::usleep(10'000);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    if (folder_ >= 0) ::close(folder_);
  }

 private:
  int folder_ = -1;
};

std::int64_t now_ns() { return hal::linux::MonotonicClock().now().ns; }

/// The file in the way of a new socket, in words; empty: nothing any more.
std::string clear_place(const std::string& path) {
  struct stat there {};
  if (::lstat(path.c_str(), &there) != 0) return {};
  if (!S_ISSOCK(there.st_mode))
    return path + ": is a file and no socket, expected a place for the control socket (--socket)";
  const int other = connect_to(path);
  const int error = errno;
  if (other >= 0) ::close(other);
  if (other >= 0 || error == EAGAIN) return path + ": another rig_controller listens there, expected another --socket";
  if (error != ECONNREFUSED)
    return path + ": " + std::strerror(error) + ", expected a place for the control socket (--socket)";
  if (there.st_uid != ::geteuid() && ::geteuid() != 0) {
    return path + ": is a socket of another user, expected a place for the control socket (--socket)";
  }
  ::unlink(path.c_str());  // of a program that has died
  return {};
}

}  // namespace

bool is_command(std::string_view word) { return find_command(word) != nullptr; }

ControlSocket::~ControlSocket() {
  for (const Client& client : clients_) ::close(client.socket);
}

ListeningSocket::~ListeningSocket() {
  if (socket_ < 0) return;
  const FolderLock lock(path_);
  struct stat there {};
  const bool own = ::lstat(path_.c_str(), &there) == 0 && there.st_ino == inode_ && there.st_dev == device_;
  if (own) ::unlink(path_.c_str());
  ::close(socket_);
}

std::string ListeningSocket::listen(const std::string& path) {
  if (!fits_address(path)) return path + ": the name of a socket has at most 107 bytes";
  const FolderLock lock(path);
  if (std::string trouble = clear_place(path); !trouble.empty()) return trouble;
  const sockaddr_un address = address_of(path);
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const mode_t before = ::umask(0117);
  const bool bound = socket_ >= 0 && ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  const int error = errno;
  ::umask(before);
  struct stat own {};
  if (!bound || ::lstat(path.c_str(), &own) != 0 || ::listen(socket_, waiting_connections) != 0) {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    return path + ": " + std::strerror(error) + ", expected a place for the control socket (--socket)";
  }
  path_ = path;
  inode_ = own.st_ino;
  device_ = own.st_dev;
  const group* rig = ::getgrnam("rig");
  // Not of that group: only this user connects.
  if (rig != nullptr) static_cast<void>(::chown(path.c_str(), static_cast<uid_t>(-1), rig->gr_gid) != 0);
  return {};
}

void ControlSocket::serve() {
  if (listening_.number() < 0) return;
  for (Client& client : clients_) receive(client);  // a stop of theirs first
  accept_all();
  for (Client& client : clients_) serve(client);
  const auto gone = std::remove_if(clients_.begin(), clients_.end(), [](const Client& client) {
    if (client.gone) ::close(client.socket);
    return client.gone;
  });
  clients_.erase(gone, clients_.end());
}

/// All who wait: what each has sent so far is read before it is asked whether there is a place for it.
void ControlSocket::accept_all() {
  for (int i = 0; i < waiting_connections; ++i) {
    Client client;
    client.socket = ::accept4(listening_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (client.socket < 0) return;
    ucred peer{};
    socklen_t size = sizeof peer;
    client.user = ::getsockopt(client.socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.uid : ~uid_t{0};
    client.since = now_ns();
    receive(client);
    if (client.gone || !make_room(client.user)) {
      constexpr std::string_view full = "{\"ok\": false, \"error\": \"too many clients wait for answers\"}\n";
      static_cast<void>(::send(client.socket, full.data(), full.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0);
      ::close(client.socket);
      continue;
    }
    clients_.push_back(std::move(client));
  }
}

/// One place for a client of this user: else the silent one that came first leaves. False: all wait for answers.
bool ControlSocket::make_room(uid_t user) {
  const auto present = [](const Client& client) { return !client.gone; };
  const auto of_user =
      std::count_if(clients_.begin(), clients_.end(), [&](const Client& c) { return present(c) && c.user == user; });
  const bool user_full = static_cast<std::size_t>(of_user) >= most_of_a_user;
  const auto all = static_cast<std::size_t>(std::count_if(clients_.begin(), clients_.end(), present));
  if (!user_full && all < most_clients) return true;
  Client* oldest = nullptr;
  for (Client& client : clients_) {
    const bool leaves = present(client) && client.request.empty() && (!user_full || client.user == user);
    if (leaves && (oldest == nullptr || client.since < oldest->since)) oldest = &client;
  }
  if (oldest == nullptr) return false;
  oldest->gone = true;
  return true;
}

/// Reads the bytes that have come; a stop in them acts now, also behind other lines.
void ControlSocket::receive(Client& client) {
  std::array<char, longest_request> bytes;
  const ssize_t got = ::recv(client.socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (got > 0) client.received.append(bytes.data(), static_cast<std::size_t>(got));
  const bool waits = got < 0 && (errno == EAGAIN || errno == EINTR);
  for (std::size_t end = client.received.find('\n', client.looked_at); end != std::string::npos;
       end = client.received.find('\n', client.looked_at)) {
    const std::string_view line = std::string_view(client.received).substr(client.looked_at, end - client.looked_at);
    client.looked_at = end + 1;
    if (without_instance(without_blank_end(line)) != "stop") continue;
    parts_.loop.stop();
    ++client.stops_taken;
  }
  // A client may send its request and shut its side: it is answered before it is left.
  const bool owed = !client.request.empty() || client.received.find('\n') != std::string::npos;
  if ((got == 0 && !owed) || (got < 0 && !waits) || client.received.size() > longest_request) client.gone = true;
}

void ControlSocket::serve(Client& client) {
  if (client.gone) return;
  if (!client.request.empty()) {
    if (parts_.progress.periods.load() < client.answer_at && --client.patience > 0) return;
    const std::string line = answer(client) + "\n";
    client.request.clear();
    client.since = now_ns();
    if (::send(client.socket, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT) !=
        static_cast<ssize_t>(line.size())) {
      client.gone = true;  // it does not read its answers
      return;
    }
  }
  const std::size_t end = client.received.find('\n');
  if (end != std::string::npos) {
    std::string line = client.received.substr(0, end);
    client.received.erase(0, end + 1);
    client.looked_at -= std::min(client.looked_at, end + 1);
    client.since = now_ns();
    take(client, std::move(line));
    return;
  }
  if (now_ns() - client.since > silence.ns) client.gone = true;
}

void ControlSocket::take(Client& client, std::string line) {
  line.resize(without_blank_end(line).size());
  std::string instance;
  const bool for_one = line.starts_with('@');
  if (for_one) {
    instance = std::string(first_word(line)).substr(1);
    line = std::string(without_instance(line));
  }
  const std::size_t blank = line.find(' ');
  const std::string word = line.substr(0, blank);
  client.request = word.empty() ? "?" : word;
  client.answer_at = parts_.progress.periods.load() + 2;
  client.patience = answer_patience;
  if (line == "stop" && client.stops_taken > 0) {
    --client.stops_taken;
    client.trouble.clear();
    parts_.recording.mark("operator: stop");
  } else if (for_one && instance != parts_.instance) {
    client.trouble = word + " is for the program " + in_quotes(instance) + ", this is " + parts_.instance;
  } else {
    client.trouble = ask(word, blank == std::string::npos ? std::string() : line.substr(blank + 1));
  }
}

/// Why a request is not passed on; empty: it is.
std::string ControlSocket::objection(const std::string& word, const std::string& rest) const {
  const Command* command = find_command(word);
  if (command == nullptr) return "unknown command " + in_quotes(word);
  if (!rest.empty() && !command->with_words) return word + " takes nothing behind it, not " + in_quotes(rest);
  const LoopProgress& progress = parts_.progress;
  const std::string_view mode = name(progress.mode.load());
  if (!command->states.empty() && mode != command->states) {
    return word + " needs state " + std::string(command->states) + ", the rig is " + std::string(mode);
  }
  if ((word == "acknowledge" || word == "rest") && !progress.at_rest.load()) {
    return word + " needs a rig that stands, the rig is " + std::string(mode) + " and still moves or has power";
  }
  if (word == "rest" && (loses_power(progress.reason.load()) || loses_power(progress.second.load()))) {
    return "rest needs a rig that has kept its power; acknowledge and arm it anew";
  }
  if (word == "rest" && !progress.proven.load()) {
    return "rest needs a rig that has been armed since it was idle; acknowledge and arm it";
  }
  return {};
}

/// Passes a request on. What is wrong with it, else nothing.
std::string ControlSocket::ask(const std::string& word, const std::string& rest) {
  if (std::string wrong = objection(word, rest); !wrong.empty()) return wrong;
  ControlLoop& loop = parts_.loop;
  if (word == "arm") loop.arm();
  if (word == "disarm") loop.disarm();
  if (word == "start") loop.start();
  if (word == "hold") loop.hold();
  if (word == "resume") loop.resume();
  if (word == "stop") loop.stop();
  if (word == "acknowledge") loop.acknowledge();
  if (word == "rest") loop.go_to_rest();
  if (word == "mark") parts_.recording.mark(rest);
  if (word == "level") {
    if (std::string wrong = change_level(rest); !wrong.empty()) return wrong;
  }
  if (word != "state" && word != "mark") parts_.recording.mark("operator: " + word + (rest.empty() ? "" : " " + rest));
  return {};
}

std::string ControlSocket::change_level(const std::string& text) {
  double level = -1.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), level);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  if (whole && level <= parts_.highest_level && parts_.loop.level(level)) return {};
  const bool limited = parts_.highest_level < ReferencePlayer::highest_level;
  return "level " + in_quotes(text) + " does not fit, expected 0 to " + shortest(parts_.highest_level) +
         (limited ? ": beyond it this run does not fit the limits" : "");
}

std::string ControlSocket::answer(const Client& client) const {
  const auto truth = [](bool value) { return value ? "true" : "false"; };
  const LoopProgress& progress = parts_.progress;
  const Mode mode = progress.mode.load();
  std::string trouble = client.trouble;
  // It was passed on, and the loop has not taken it.
  if (trouble.empty() && client.request == "acknowledge" && mode == Mode::safe) {
    trouble = "acknowledge is not taken: what is wrong lasts, the rig is safe";
  }
  if (trouble.empty() && client.request == "rest" && parts_.rest_refusals) {
    if (const std::string why = parts_.rest_refusals(); !why.empty()) trouble = "rest is not taken: " + why;
  }
  const std::string refused = parts_.refusals ? parts_.refusals() : std::string();
  if (trouble.empty() && client.request == "arm" && mode == Mode::safe && !refused.empty()) {
    trouble = "not armed, failed checks: " + refused;
  }
  std::array<char, 64> position{};
  std::snprintf(position.data(), position.size(), "%.9g", progress.position.load());
  std::string json = std::string("{\"ok\": ") + truth(trouble.empty()) + ", \"command\": " + json_text(client.request);
  if (!trouble.empty()) json += ", \"error\": " + json_text(trouble);
  json += ", \"state\": " + json_text(name(mode)) + ", \"reason\": " + json_text(name(progress.reason.load())) +
          ", \"second_reason\": " + json_text(name(progress.second.load())) +
          ", \"enabled\": " + truth(progress.enabled.load()) + ", \"at_rest\": " + truth(progress.at_rest.load()) +
          ", \"held\": " + truth(progress.held.load()) + ", \"command_m\": " + position.data() +
          ", \"periods\": " + std::to_string(progress.periods.load()) + ", \"instance\": " + json_text(parts_.instance);
  if (!refused.empty()) json += ", \"failed_checks\": " + json_text(refused);
  if (parts_.publisher != nullptr) {
    json += ", \"published\": " + std::to_string(parts_.publisher->sent()) +
            ", \"publish_lost\": " + std::to_string(parts_.publisher->lost());
  }
  return json + "}";
}

std::string socket_path(const std::string& asked, const std::string& described) {
  if (!asked.empty()) return asked;
  if (!described.empty()) return described;
  const char* directory = std::getenv("RUNTIME_DIRECTORY");
  return directory != nullptr && *directory == '/' ? std::string(directory) + "/control.sock"
                                                   : std::string(usual_socket);
}

std::string clients_path(const std::string& asked, const std::string& described, const std::string& rig,
                         const std::string& directory) {
  namespace fs = std::filesystem;
  if (!asked.empty()) return asked;
  if (!described.empty()) return described;
  std::error_code error;
  const fs::path of_rig = fs::path(directory) / fs::path(rig).stem() / "control.sock";
  if (!rig.empty() && fs::is_socket(of_rig, error)) return of_rig.string();
  const fs::path usual = fs::path(directory) / "control.sock";
  if (!rig.empty() || fs::is_socket(usual, error)) return usual.string();
  std::vector<std::string> services;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    const fs::path socket = entry.path() / "control.sock";
    std::error_code none;
    if (fs::is_socket(socket, none)) services.push_back(socket.string());
  }
  if (services.empty()) return usual.string();
  std::sort(services.begin(), services.end());
  if (services.size() == 1) return services.front();
  std::string all;
  for (const std::string& socket : services) all += (all.empty() ? "" : ", ") + socket;
  throw UsageError("several programs listen (" + all + "), expected --socket or --rig, which says which one is meant");
}

int ask_controller(const std::string& path, const std::string& line) {
  if (!is_command(first_word(line))) {
    std::fprintf(stderr, "rig_controller: unknown command %s, see rig_controller --help\n", in_quotes(line).c_str());
    return 2;
  }
  const std::int64_t until = now_ns() + clients_patience_ms * 1'000'000;
  int connection = fits_address(path) ? connect_to(path) : -1;
  // So many wait at once that the kernel keeps no more: they are taken up every 10 ms.
  while (connection < 0 && errno == EAGAIN && now_ns() < until) {
    ::usleep(1000);
    connection = connect_to(path);
  }
  if (connection < 0 && errno == EAGAIN) {
    std::fprintf(stderr, "rig_controller: %s: no answer: the program there takes no connection\n", path.c_str());
    return 6;
  }
  if (connection < 0) {
    std::fprintf(stderr, "rig_controller: %s: no program listens there (%s)\n", path.c_str(), std::strerror(errno));
    return 6;
  }
  const std::string request = one_line(line) + "\n";
  std::string reply;
  bool open = ::send(connection, request.data(), request.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
              static_cast<ssize_t>(request.size());
  while (open && reply.find('\n') == std::string::npos) {
    pollfd readable{connection, POLLIN, 0};
    const std::int64_t left = (until - now_ns()) / 1'000'000;
    if (left <= 0 || ::poll(&readable, 1, static_cast<int>(left)) != 1) break;
    std::array<char, 1024> bytes;
    const ssize_t got = ::recv(connection, bytes.data(), bytes.size(), MSG_DONTWAIT);
    open = got > 0 && reply.size() < 16 * longest_request;
    if (got > 0) reply.append(bytes.data(), static_cast<std::size_t>(got));
  }
  ::close(connection);
  if (reply.find('\n') == std::string::npos) {
    std::fprintf(stderr, "rig_controller: %s: no answer; whether the program has taken %s is unknown\n", path.c_str(),
                 in_quotes(line).c_str());
    return 6;
  }
  std::fputs(reply.c_str(), stdout);
  return reply.find("\"ok\": true") != std::string::npos ? 0 : 6;
}

}  // namespace firmware::controller
