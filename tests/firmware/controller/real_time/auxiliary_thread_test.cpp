#include "firmware/controller/real_time/auxiliary_thread.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>

#include <cstdint>

namespace {

using firmware::controller::AuxiliaryThread;
using firmware::controller::cpus_without;

// The loop's CPU is the loop's: threads beside it keep off, unless it is the only one.
TEST(AuxiliaryThread, KeepsOffTheLoopsCpu) {
  cpu_set_t all;
  ASSERT_EQ(::sched_getaffinity(0, sizeof all, &all), 0);
  int first = 0;
  while (!CPU_ISSET(static_cast<unsigned>(first), &all)) ++first;
  const cpu_set_t others = cpus_without(first);
  EXPECT_EQ(CPU_ISSET(static_cast<unsigned>(first), &others) != 0, CPU_COUNT(&all) == 1);

  cpu_set_t seen;
  int policy = -1;
  AuxiliaryThread thread(others, [&] {
    ::sched_getaffinity(0, sizeof seen, &seen);
    policy = ::sched_getscheduler(0);
  });
  thread.join();
  EXPECT_TRUE(CPU_EQUAL(&seen, &others));
  EXPECT_EQ(policy, SCHED_OTHER);

  const cpu_set_t any = cpus_without(-1);
  EXPECT_TRUE(CPU_EQUAL(&any, &all));
}

// A handler of a stack overflow needs another stack than the one that has overflowed.
TEST(AuxiliaryThread, HasAStackForSignalHandlers) {
  stack_t stack{};
  AuxiliaryThread thread(cpus_without(-1), [&] { ::sigaltstack(nullptr, &stack); });
  thread.join();
  EXPECT_EQ(stack.ss_flags & SS_DISABLE, 0);
  EXPECT_GE(stack.ss_size, 16U * 1024U);
}

}  // namespace
