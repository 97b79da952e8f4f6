// Counts the model steps that the simulations of a diagnosis cost.
#pragma once

#include <atomic>

namespace host_sim::identification {

/// Work in steps of the model, counted from several threads: the same on every machine, so a budget of it ends a search
/// at the same place everywhere.
class SpentWork {
 public:
  void add(double steps) { steps_.fetch_add(steps, std::memory_order_relaxed); }
  [[nodiscard]] double steps() const { return steps_.load(std::memory_order_relaxed); }

 private:
  std::atomic<double> steps_{0.0};
};

}  // namespace host_sim::identification
