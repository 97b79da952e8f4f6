// What the verdict says of a machine, from files as the kernel shows them.
#include "firmware/controller/real_time/real_time.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::controller::look_at_settings;
using firmware::controller::Verdict;
using ::testing::HasSubstr;
using ::testing::Not;

/// A machine of files; the loop runs on CPU 3 with priority 80.
class Machine {
 public:
  void write(const std::string& file, const std::string& text) {
    std::filesystem::create_directories((folder_ / file).parent_path());
    folder_.write(file, text);
  }
  /// A thread of the kernel: name, priority, CPUs that it may use.
  void thread(int id, const std::string& name, int priority, const std::string& cpus) {
    const std::string at = "proc/" + std::to_string(id) + "/";
    write(at + "comm", name + "\n");
    std::string stat = std::to_string(id) + " (" + name + ") S";
    for (int field = 4; field < 40; ++field) stat += " 0";
    write(at + "stat", stat + " " + std::to_string(priority) + " 1 0\n");
    write(at + "status", "Name:\t" + name + "\nCpus_allowed_list:\t" + cpus + "\n");
  }
  [[nodiscard]] std::string verdict() const {
    Verdict verdict;
    look_at_settings(verdict, 3, 80, folder_.path());
    EXPECT_TRUE(verdict.granted()) << "nothing of this is needed, all of it is said";
    return verdict.text();
  }

 private:
  support::TemporaryFolder folder_;
};

TEST(MachineSettings, AreInOrderOnAMachineMadeForRealTime) {
  Machine machine;
  machine.write("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "performance\n");
  machine.write("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
  machine.write("sys/kernel/mm/transparent_hugepage/enabled", "always madvise [never]\n");
  machine.write("sys/kernel/debug/sched/preempt", "none voluntary (full)\n");
  machine.thread(45, "irq/45-spi 0", 50, "0-2");  // on other CPUs
  machine.thread(46, "irq/46-dma", 90, "0-3");    // above the loop
  machine.thread(47, "kworker/3:0", 0, "3");
  EXPECT_THAT(machine.verdict(), Not(HasSubstr("weak")));
}

TEST(MachineSettings, SayWhatWeakensRealTime) {
  Machine machine;
  machine.write("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "powersave\n");
  machine.write("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
  machine.write("sys/kernel/mm/transparent_hugepage/enabled", "[always] madvise never\n");
  machine.write("sys/kernel/debug/sched/preempt", "none (voluntary) full\n");
  machine.thread(45, "irq/45-spi 0", 50, "0-3");
  const std::string said = machine.verdict();
  for (const char* words : {"weak     frequency: powersave", "weak     throttling: real-time tasks get 950000 us",
                            "weak     huge pages: always", "weak     preemption: voluntary: boot with preempt=full",
                            "weak     interrupts: irq/45-spi 0 (50) wait while the loop spins on CPU 3"}) {
    EXPECT_THAT(said, HasSubstr(words));
  }
}

// A container or a small board shows none of these files.
TEST(MachineSettings, AreUnknownWithoutFiles) {
  const Machine machine;
  EXPECT_THAT(machine.verdict(), Not(HasSubstr("weak")));
}

}  // namespace
