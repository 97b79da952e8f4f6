// What a diagnosis has cost so far: model steps, simulations, candidates, and what was left out to save more.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace host_sim::identification {

/// Shared by all recordings of a problem and by every copy and part of it, counted from several threads. Steps and not
/// seconds: the same on every machine, so a budget of them ends a search at the same place everywhere.
class SpentWork {
 public:
  void add_simulation(double steps) {
    steps_.fetch_add(steps, std::memory_order_relaxed);
    simulations_.fetch_add(1, std::memory_order_relaxed);
  }
  void add_candidates(std::size_t count) { candidates_.fetch_add(count, std::memory_order_relaxed); }
  /// What was not tried, since the budget was spent; each once.
  void leave_out(const std::string& step) {
    const std::lock_guard lock(mutex_);
    if (std::find(left_out_.begin(), left_out_.end(), step) == left_out_.end()) left_out_.push_back(step);
  }

  [[nodiscard]] double steps() const { return steps_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t simulations() const { return simulations_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t candidates() const { return candidates_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::vector<std::string> left_out() const {
    const std::lock_guard lock(mutex_);
    return left_out_;
  }

 private:
  std::atomic<double> steps_{0.0};
  std::atomic<std::size_t> simulations_{0}, candidates_{0};
  mutable std::mutex mutex_;
  std::vector<std::string> left_out_;
};

}  // namespace host_sim::identification
