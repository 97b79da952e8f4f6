// Threads beside the control loop: recording and supervision.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <signal.h>

#include <functional>
#include <memory>

namespace firmware::controller {

/// The CPUs that the calling thread may use, without the loop's; all of them if the loop's is the only one.
[[nodiscard]] cpu_set_t cpus_without(int loop_cpu);

/// Gives the calling thread a stack of its own for signal handlers, so that a stack overflow is handled as well.
class AlternateStack {
 public:
  AlternateStack();
  ~AlternateStack();
  AlternateStack(const AlternateStack&) = delete;
  AlternateStack& operator=(const AlternateStack&) = delete;

 private:
  static constexpr std::size_t size = std::size_t{64} * 1024;
  std::unique_ptr<char[]> memory_ = std::make_unique<char[]>(size);
};

/// A thread with ordinary scheduling (SCHED_OTHER, whatever its maker has), on the given CPUs, with a small stack
/// because memory is locked, and with an AlternateStack. It ends when its function returns; joined by join().
class AuxiliaryThread {
 public:
  AuxiliaryThread(const cpu_set_t& cpus, std::function<void()> function);
  AuxiliaryThread(const AuxiliaryThread&) = delete;
  AuxiliaryThread& operator=(const AuxiliaryThread&) = delete;
  ~AuxiliaryThread() { join(); }

  void join();

 private:
  std::function<void()> function_;
  pthread_t thread_{};
  bool joined_ = false;
};

}  // namespace firmware::controller
