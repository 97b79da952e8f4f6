// The operator's way to a running program: a socket on this machine, one word a line.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/controller/publishing/publisher.hpp"
#include "firmware/controller/recording/recording_thread.hpp"
#include "firmware/loop/control_loop.hpp"

namespace firmware::controller {

/// Progress of the loop, for the other threads; updated after each period.
struct LoopProgress {
  std::atomic<std::uint64_t> periods{0};
  std::atomic<Mode> mode{Mode::idle};
  std::atomic<Reason> reason{Reason::none};
  std::atomic<Reason> second{Reason::none};
  std::atomic<bool> enabled{false};
  std::atomic<bool> at_rest{true};
  std::atomic<bool> held{false};
  std::atomic<bool> proven{true};     ///< `rest` may give power: an arming has passed
  std::atomic<double> position{0.0};  ///< of the command [m]
};

inline constexpr std::string_view usual_socket = "/run/rigtwin/control.sock";

/// A Unix domain socket under a name of its own. Nobody is answered yet: who connects waits for a ControlSocket.
class ListeningSocket {
 public:
  ListeningSocket() = default;
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  ~ListeningSocket();  ///< Removes its file, if that is still its own.

  /// What is wrong, in one line; empty: it listens. A socket that nobody answers is replaced, nothing else is.
  [[nodiscard]] std::string listen(const std::string& path);

  [[nodiscard]] int number() const { return socket_; }  ///< −1: it does not listen

 private:
  int socket_ = -1;
  std::string path_;
  ino_t inode_ = 0;  ///< of the socket's file
  dev_t device_ = 0;
};

/// Listens on a Unix domain socket for lines such as "start" or "level 0.8" and answers each with one line of JSON:
/// the state after the request. Never a network port. Who may connect is said by the file: mode 0660, group rig.
///
/// One thread calls serve() again and again; it never waits. A request is taken up by the loop's next period; its
/// answer comes two periods later, or after half a second without a period.
///
/// `stop` is taken before everything else: of every client, and of one that has no place any more. A client that says
/// nothing for ten seconds is left; each user has eight places, and a ninth client of theirs takes the place of the one
/// that has been silent longest.
///
/// A line "@INSTANCE arm" is for that instance (new_instance) alone; another one refuses it, except `stop`.
class ControlSocket {
 public:
  struct Parts {
    ControlLoop& loop;
    RecordingThread& recording;
    const LoopProgress& progress;
    double highest_level;        ///< of the command `level`, so that the run stays within the limits
    const Publisher* publisher;  ///< none: nothing is published
    std::string instance;
    std::function<std::string()> refusals;       ///< all checks that the last arming has failed, in words
    std::function<std::string()> rest_refusals;  ///< why the last `rest` was not taken, in words
  };
  ControlSocket(const Parts& parts, const ListeningSocket& listening) : parts_(parts), listening_(listening) {}
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;
  ~ControlSocket();

  void serve();

 private:
  struct Client {
    int socket = -1;
    uid_t user = 0;
    std::int64_t since = 0;  ///< of its last whole line, or of its coming [ns]
    std::string received;
    std::size_t looked_at = 0;  ///< bytes of `received` in which a stop was looked for
    int stops_taken = 0;        ///< lines of `received` that say stop and have been taken up
    std::string request;        ///< whose answer is due
    std::string trouble;
    std::uint64_t answer_at = 0;  ///< period
    int patience = 0;             ///< calls of serve() until it is answered anyway
    bool gone = false;
  };

  void accept_all();
  void receive(Client& client);
  [[nodiscard]] bool make_room(uid_t user);
  void serve(Client& client);
  void take(Client& client, std::string line);
  [[nodiscard]] std::string ask(const std::string& word, const std::string& rest);
  [[nodiscard]] std::string objection(const std::string& word, const std::string& rest) const;
  [[nodiscard]] std::string change_level(const std::string& text);
  [[nodiscard]] std::string answer(const Client& client) const;

  Parts parts_;
  const ListeningSocket& listening_;
  std::vector<Client> clients_;
};

/// Where a program listens: the first that is given of the command line, the description ([controller] socket), the
/// directory that systemd has made for this instance (RUNTIME_DIRECTORY), else the usual path.
[[nodiscard]] std::string socket_path(const std::string& asked, const std::string& described);

/// Where the program of a rig is asked: as above; without path and description the usual socket, or the only one of the
/// services' (/run/rigtwin/NAME/control.sock; `rig`: the file NAME.toml). Several: InputError that lists them.
[[nodiscard]] std::string clients_path(const std::string& asked, const std::string& described, const std::string& rig,
                                       const std::string& directory = "/run/rigtwin");

/// The program as a client: sends the words as one line, prints the answer. Its exit status: 0 done, 2 unknown command,
/// 6 no program listens, it does not answer within two seconds, or the state does not allow it.
[[nodiscard]] int ask_controller(const std::string& path, const std::string& line);

/// True for a command of the socket.
[[nodiscard]] bool is_command(std::string_view word);

}  // namespace firmware::controller
