#include "firmware/controller/supervisor.hpp"

#include <ctime>

#include "firmware/controller/safety/emergency.hpp"
#include "firmware/controller/safety/systemd_notify.hpp"

namespace firmware::controller {

sigset_t supervised_signals() {
  sigset_t signals;
  ::sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU, SIGALRM, SIGVTALRM, SIGPROF,
                           SIGPOLL, SIGPWR, SIGSTKFLT}) {
    ::sigaddset(&signals, signal);
  }
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) ::sigaddset(&signals, signal);
  return signals;
}

void block_signals() {
  for (const int signal : {SIGPIPE, SIGXFSZ, SIGTSTP, SIGTTIN, SIGTTOU}) ::signal(signal, SIG_IGN);
  const sigset_t signals = supervised_signals();
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

Supervisor::Supervisor(const cpu_set_t& cpus, const Parts& parts)
    : parts_(parts), thread_(cpus, [this] { supervise(); }) {}

void Supervisor::finish() {
  end_.store(true);
  thread_.join();
}

void Supervisor::end_run(Cause cause) {
  Cause none = Cause::none;
  if (!cause_.compare_exchange_strong(none, cause)) return;
  parts_.loop.end();
  extend_timeout(parts_.longest_return + 2.0);
}

void Supervisor::supervise() {
  std::uint64_t seen = 0;
  while (!end_.load()) {
    const std::uint64_t periods = parts_.progress.periods.load(std::memory_order_relaxed);
    if (periods != seen) notify("WATCHDOG=1");
    seen = periods;
    if (parts_.recording.failed()) end_run(Cause::disk);
    if (parts_.journal.lost() > 0) end_run(Cause::lost_records);
    parts_.socket.serve();
    await_signal();
  }
}

void Supervisor::await_signal() {
  const sigset_t awaited = supervised_signals();
  const timespec pause{0, 10'000'000};
  const int signal = ::sigtimedwait(&awaited, nullptr, &pause);
  if (signal <= 0) return;
  if (signal == SIGUSR1) {
    parts_.recording.print_soon();
    return;
  }
  if (signal == SIGALRM && emergency_under_way()) {  // the emergency return has taken longer than it may
    ::signal(SIGALRM, SIG_DFL);
    sigset_t alarm;
    ::sigemptyset(&alarm);
    ::sigaddset(&alarm, SIGALRM);
    ::pthread_sigmask(SIG_UNBLOCK, &alarm, nullptr);
    ::raise(SIGALRM);
  }
  int none = 0;
  if (!signal_.compare_exchange_strong(none, signal)) {  // asked again: whoever does so wants the rig to stand still
    parts_.loop.stop();
    return;
  }
  end_run(Cause::signal);
}

}  // namespace firmware::controller
