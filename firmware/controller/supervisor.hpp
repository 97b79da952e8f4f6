// The thread that supervises a session: signals, systemd's watchdog, the operator's socket, lost records.
#pragma once

#include <signal.h>

#include <atomic>
#include <cstdint>

#include "firmware/controller/control_socket.hpp"
#include "firmware/controller/real_time/auxiliary_thread.hpp"
#include "firmware/controller/recording/recording_thread.hpp"
#include "firmware/loop/control_loop.hpp"
#include "firmware/loop/journal.hpp"

namespace firmware::controller {

/// Why the program itself, not the control loop, ends a run.
enum class Cause : int { none, signal, disk, lost_records, heap };

/// Signals that the supervisor takes: all that end a program and can be caught, but for traps and for those that are
/// ignored. SIGUSR1 has the histograms printed, any other one ends the run in good order; a second one brakes and
/// holds.
[[nodiscard]] sigset_t supervised_signals();

/// Blocks the supervised signals in the calling thread and in the threads that it makes, and ignores those that are no
/// reason to end: SIGPIPE (a reader went away), SIGXFSZ (a full disk), SIGTSTP, SIGTTIN, SIGTTOU (the terminal).
void block_signals();

/// Ordinary priority, and never waits for the disk or the console. Ends the run on a signal, on lost records and on a
/// recording that cannot be written; serves the socket; tells systemd that the program is alive for as long as the loop
/// makes periods.
class Supervisor {
 public:
  struct Parts {
    ControlLoop& loop;
    const Journal& journal;
    RecordingThread& recording;
    const LoopProgress& progress;
    ControlSocket& socket;
    double longest_return;  ///< [s]
  };
  Supervisor(const cpu_set_t& cpus, const Parts& parts);
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;
  ~Supervisor() { finish(); }

  void finish();

  [[nodiscard]] Cause cause() const { return cause_.load(); }  ///< the first
  [[nodiscard]] int signal() const { return signal_.load(); }  ///< that ended the run; 0: none
  /// Ends the run for this cause. From any thread.
  void end_run(Cause cause);

 private:
  void supervise();
  void await_signal();

  Parts parts_;
  std::atomic<bool> end_{false};
  std::atomic<Cause> cause_{Cause::none};
  std::atomic<int> signal_{0};
  AuxiliaryThread thread_;  // last: it uses the others
};

}  // namespace firmware::controller
