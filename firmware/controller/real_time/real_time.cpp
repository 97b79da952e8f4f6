#include "firmware/controller/real_time/real_time.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace firmware::controller {
namespace {

std::string first_line(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// "0-2,5" names 1.
bool names(const std::string& list, int cpu) {
  std::size_t at = 0;
  while (at < list.size()) {
    std::size_t end = std::min(list.find(',', at), list.size());
    const std::string part = list.substr(at, end - at);
    const std::size_t dash = part.find('-');
    const int low = std::atoi(part.c_str());
    const int high = dash == std::string::npos ? low : std::atoi(part.c_str() + dash + 1);
    if (!part.empty() && cpu >= low && cpu <= high) return true;
    at = end + 1;
  }
  return false;
}

/// A page at a time, so that no first touch happens in the loop.
[[gnu::noinline]] void touch_stack() {
  constexpr std::size_t size = 256 * 1024;
  volatile char stack[size];
  for (std::size_t i = 0; i < size; i += 1024) stack[i] = 0;
  static_cast<void>(stack[0]);
}

}  // namespace

bool Verdict::granted() const {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return f.good || !f.needed; });
}

std::string Verdict::text() const {
  std::string text = granted() ? "real time: granted\n" : "real time: NOT GRANTED\n";
  for (const Finding& f : findings) {
    text += std::string(f.good     ? "  ok       "
                        : f.needed ? "  MISSING  "
                                   : "  weak     ") +
            f.what + ": " + f.found + "\n";
  }
  return text;
}

std::string Verdict::summary() const {
  std::string text;
  for (const Finding& f : findings) {
    if (f.needed || !f.good) text += (text.empty() ? "" : "; ") + f.what + ": " + f.found;
  }
  return text;
}

void lock_memory(Verdict& verdict) {
  ::mallopt(M_TRIM_THRESHOLD, -1);  // memory that was given back would have to be touched anew
  ::mallopt(M_MMAP_MAX, 0);
  const bool locked = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  const int error = errno;
  touch_stack();
  verdict.findings.push_back(
      {"memory", locked ? "locked" : std::string("not locked: ") + std::strerror(error) + "; raise the memlock limit",
       locked, true});
}

void schedule_loop(Verdict& verdict, int priority, int cpu) {
  if (cpu >= 0) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(cpu), &one);
    const bool bound = ::sched_setaffinity(0, sizeof one, &one) == 0;
    verdict.findings.push_back({"CPU",
                                bound ? "loop on CPU " + std::to_string(cpu)
                                      : "cannot run on CPU " + std::to_string(cpu) + ": " + std::strerror(errno),
                                bound, true});
  }
  sched_param parameters{};
  parameters.sched_priority = priority;
  const bool granted = ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
  verdict.findings.push_back({"scheduler",
                              granted ? "SCHED_FIFO " + std::to_string(priority)
                                      : "SCHED_FIFO " + std::to_string(priority) + " refused: " + std::strerror(errno) +
                                            "; raise the rtprio limit",
                              granted, true});
}

void look_at_machine(Verdict& verdict, int cpu) {
  utsname name{};
  ::uname(&name);
  const std::string version = name.version;
  const bool rt = version.find("PREEMPT_RT") != std::string::npos || first_line("/sys/kernel/realtime") == "1";
  const bool preempt = version.find("PREEMPT") != std::string::npos;
  verdict.findings.push_back({"kernel",
                              std::string(name.release) + ", " +
                                  (rt        ? "PREEMPT_RT"
                                   : preempt ? "preemptible, not PREEMPT_RT: wakes late now and then"
                                             : "not preemptible: wakes late"),
                              rt});
  const std::string source = first_line("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  const bool good = source == "tsc" || source == "arch_sys_counter";
  verdict.findings.push_back(
      {"clock source", source.empty() ? "unknown" : source + (good ? "" : ": reading it may be slow"), good});
  const std::string isolated = first_line("/sys/devices/system/cpu/isolated");
  const bool alone = cpu >= 0 && names(isolated, cpu);
  verdict.findings.push_back({"isolation",
                              alone              ? "CPU " + std::to_string(cpu) + " is isolated"
                              : isolated.empty() ? "no CPU is isolated (isolcpus=)"
                                                 : "isolated are " + isolated + ", the loop is not on one of them",
                              alone});
  const int latency =
      ::open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);  // never closed: the wish ends with the program
  const std::int32_t none = 0;
  const bool awake = latency >= 0 && ::write(latency, &none, sizeof none) == static_cast<ssize_t>(sizeof none);
  const std::string driver = first_line("/sys/devices/system/cpu/cpuidle/current_driver");
  const bool sleepless = driver.empty() || driver == "none";
  verdict.findings.push_back({"C-states",
                              awake       ? "held at the shallowest"
                              : sleepless ? "none"
                                          : driver + ", deep ones not forbidden: no access to /dev/cpu_dma_latency",
                              awake || sleepless});
}

namespace {

/// "always [madvise] never" names madvise.
std::string chosen(const std::string& line) {
  const std::size_t begin = line.find_first_of("[("), end = line.find_first_of("])");
  return begin == std::string::npos || end == std::string::npos || end < begin
             ? line
             : line.substr(begin + 1, end - begin - 1);
}

/// Value of "Key:\tvalue" in a file; empty without it.
std::string entry(const std::filesystem::path& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key + ":")) continue;
    const std::size_t at = line.find_first_not_of(" \t", key.size() + 1);
    return at == std::string::npos ? std::string() : line.substr(at);
  }
  return {};
}

/// The real-time priority of a thread, field 40 of its stat; 0: none, or no such thread.
int priority_of(const std::filesystem::path& thread) {
  const std::string line = first_line(thread / "stat");
  std::size_t at = line.rfind(')');  // behind the name, which may hold spaces
  constexpr int fields_behind_name = 38;
  for (int i = 0; i < fields_behind_name && at != std::string::npos; ++i) at = line.find(' ', at + 1);
  return at == std::string::npos ? 0 : std::atoi(line.c_str() + at + 1);
}

/// "irq/45-spi0 (50), …": interrupt threads that may run on this CPU, below this priority.
std::string starved_interrupts(const std::filesystem::path& root, int cpu, int priority) {
  std::string list;
  std::error_code error;
  for (const auto& process : std::filesystem::directory_iterator(root / "proc", error)) {
    const std::string name = first_line(process.path() / "comm");
    if (!name.starts_with("irq/")) continue;
    const int own = priority_of(process.path());
    if (own <= 0 || own >= priority || !names(entry(process.path() / "status", "Cpus_allowed_list"), cpu)) continue;
    list += (list.empty() ? "" : ", ") + name + " (" + std::to_string(own) + ")";
  }
  return list;
}

}  // namespace

void look_at_settings(Verdict& verdict, int cpu, int priority, const std::filesystem::path& root) {
  const auto add = [&](const char* what, const std::string& found, bool good) {
    verdict.findings.push_back({what, found, good});
  };
  const std::string number = std::to_string(std::max(cpu, 0));
  const std::string governor =
      first_line(root / "sys/devices/system/cpu" / ("cpu" + number) / "cpufreq/scaling_governor");
  const bool fast = governor.empty() || governor == "performance";
  add("frequency",
      governor.empty() ? "not scaled"
                       : governor + (fast ? "" : ": CPU " + number + " may be slow when a period begins"),
      fast);
  const std::string runtime = first_line(root / "proc/sys/kernel/sched_rt_runtime_us");
  const bool free = runtime.empty() || runtime == "-1";
  add("throttling",
      free ? "none"
           : "real-time tasks get " + runtime + " us of each period of theirs (kernel.sched_rt_runtime_us = -1)",
      free);
  const std::string huge = chosen(first_line(root / "sys/kernel/mm/transparent_hugepage/enabled"));
  const bool small = huge != "always";
  add("huge pages", huge.empty() ? "none" : huge + (small ? "" : ": the kernel may stop the loop to join pages"),
      small);
  const std::string preemption = first_line(root / "sys/kernel/debug/sched/preempt");
  if (!preemption.empty()) {
    const std::string mode = chosen(preemption);
    add("preemption", mode + (mode == "full" ? "" : ": boot with preempt=full"), mode == "full");
  }
  const std::string starved = cpu >= 0 ? starved_interrupts(root, cpu, priority) : std::string();
  add("interrupts",
      starved.empty() ? "none waits for the loop" : starved + " wait while the loop spins on CPU " + number,
      starved.empty());
}

}  // namespace firmware::controller
