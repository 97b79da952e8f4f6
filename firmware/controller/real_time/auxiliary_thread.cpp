#include "firmware/controller/real_time/auxiliary_thread.hpp"

#include <utility>

#include "model/numerics/require.hpp"

namespace firmware::controller {

cpu_set_t cpus_without(int loop_cpu) {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  ::sched_getaffinity(0, sizeof cpus, &cpus);
  cpu_set_t others = cpus;
  if (loop_cpu >= 0) CPU_CLR(static_cast<unsigned>(loop_cpu), &others);
  return CPU_COUNT(&others) > 0 ? others : cpus;
}

AlternateStack::AlternateStack() {
  stack_t own{};
  own.ss_sp = memory_.get();
  own.ss_size = size;
  ::sigaltstack(&own, nullptr);
}

AlternateStack::~AlternateStack() {
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  ::sigaltstack(&none, nullptr);
}

AuxiliaryThread::AuxiliaryThread(const cpu_set_t& cpus, std::function<void()> function)
    : function_(std::move(function)) {
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, std::size_t{512} * 1024);
  ::pthread_attr_setaffinity_np(&attributes, sizeof cpus, &cpus);
  const sched_param ordinary{};
  ::pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  ::pthread_attr_setschedpolicy(&attributes, SCHED_OTHER);
  ::pthread_attr_setschedparam(&attributes, &ordinary);
  const int error = ::pthread_create(
      &thread_, &attributes,
      [](void* self) -> void* {
        const AlternateStack stack;
        static_cast<AuxiliaryThread*>(self)->function_();
        return nullptr;
      },
      this);
  ::pthread_attr_destroy(&attributes);
  model::require(error == 0, "a thread beside the control loop");
}

void AuxiliaryThread::join() {
  if (joined_) return;
  joined_ = true;
  ::pthread_join(thread_, nullptr);
}

}  // namespace firmware::controller
