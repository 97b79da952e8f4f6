// What real time needs of the machine, and whether it was granted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace firmware::controller {

/// One line of the verdict.
struct Finding {
  std::string what;
  std::string found;
  bool good = true;
  bool needed = false;  ///< without it the program refuses, unless told --no-realtime
};

struct Verdict {
  std::vector<Finding> findings;

  [[nodiscard]] bool granted() const;
  /// For people: a line each, what is missing marked.
  [[nodiscard]] std::string text() const;
  /// For the comments of a recording: "SCHED_FIFO 80, memory locked, …" or what is missing.
  [[nodiscard]] std::string summary() const;
};

/// Locks memory, now and to come, and touches the stack that the loop will use. First.
void lock_memory(Verdict& verdict);

/// Puts the calling thread under SCHED_FIFO with this priority on this CPU (−1: any). Last.
void schedule_loop(Verdict& verdict, int priority, int cpu);

/// Keeps the CPUs out of deep sleep for as long as the program lives; kernel, clock source, isolation as they are.
void look_at_machine(Verdict& verdict, int cpu);

/// Settings of the kernel that weaken real time: frequency governor of the loop's CPU (−1: CPU 0), throttling of
/// real-time tasks, transparent huge pages, the mode of a kernel with PREEMPT_DYNAMIC, interrupt threads on the loop's
/// CPU whose priority is below the loop's – they wait while it spins before each period. `root`: the folder of sys/ and
/// proc/.
void look_at_settings(Verdict& verdict, int cpu, int priority, const std::filesystem::path& root = "/");

}  // namespace firmware::controller
