// The operator's way to a running program: a socket on this machine, one word a line.
#pragma once

#include <atomic>
#include <cstdint>
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
  std::atomic<double> position{0.0};  ///< of the command [m]
};

inline constexpr std::string_view usual_socket = "/run/rigtwin/control.sock";

/// Listens on a Unix domain socket for lines such as "start" or "level 0.8" and answers each with one line of JSON:
/// the state after the request. Never a network port. Who may connect is said by the file: mode 0660, group rig.
///
/// One thread calls serve() again and again; it never waits. A request is taken up by the loop's next period; its
/// answer comes two periods later, or after half a second without a period.
class ControlSocket {
 public:
  /// `highest_level`: of the command `level`, so that the run stays within the limits. `publisher`: none: nothing is
  /// published.
  ControlSocket(ControlLoop& loop, RecordingThread& recording, const LoopProgress& progress, double highest_level,
                const Publisher* publisher)
      : loop_(loop), recording_(recording), progress_(progress), highest_level_(highest_level), publisher_(publisher) {}
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;
  ~ControlSocket();

  /// What is wrong, in one line; empty: it listens. A file of a program that has died is replaced.
  [[nodiscard]] std::string listen(const std::string& path);

  void serve();

 private:
  struct Client {
    int socket = -1;
    std::string received;
    std::string request;  ///< whose answer is due
    std::string trouble;
    std::uint64_t answer_at = 0;  ///< period
    int patience = 0;             ///< calls of serve() until it is answered anyway
  };

  [[nodiscard]] bool serve(Client& client);
  void take(Client& client, const std::string& line);
  [[nodiscard]] std::string ask(const std::string& word, const std::string& rest);
  [[nodiscard]] std::string answer(const Client& client) const;

  ControlLoop& loop_;
  RecordingThread& recording_;
  const LoopProgress& progress_;
  double highest_level_;
  const Publisher* publisher_;
  int socket_ = -1;
  std::string path_;
  std::vector<Client> clients_;
};

/// The first path that is given: on the command line, in the description ([controller] socket), else the usual one.
[[nodiscard]] std::string socket_path(const std::string& asked, const std::string& described);

/// The program as a client: sends the words as one line, prints the answer. Its exit status: 0 done, 2 unknown command,
/// 6 no program listens, or the state does not allow it.
[[nodiscard]] int ask_controller(const std::string& path, const std::string& line);

/// True for a command of the socket.
[[nodiscard]] bool is_command(std::string_view word);

}  // namespace firmware::controller
