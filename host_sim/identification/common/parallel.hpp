// Independent work on all processors.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace host_sim::identification {

/// Whether this thread is inside of such work.
inline bool& inside_work() {
  thread_local bool inside = false;
  return inside;
}

/// The number of processors that for_all() would use here.
inline std::size_t free_processors() { return inside_work() ? 1 : std::max(1U, std::thread::hardware_concurrency()); }

/// work(i) for i = 0 … count − 1 on all processors; inside such work, one after the other. The first exception is
/// passed on when all have ended.
template <class Work>
void for_all(std::size_t count, const Work& work) {
  if (inside_work() || count < 2) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto run = [&] {
    inside_work() = true;
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::lock_guard lock(failing);
      failure = std::current_exception();
    }
    inside_work() = false;
  };
  {
    std::vector<std::jthread> threads;
    const std::size_t helpers = std::min<std::size_t>(count, free_processors());
    for (std::size_t t = 1; t < helpers; ++t) threads.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace host_sim::identification
