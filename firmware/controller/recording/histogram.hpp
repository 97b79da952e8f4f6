// How long things took: counted, not kept.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace firmware::controller {

/// Spans in nanoseconds, in 32 classes an octave (3 % wide). One thread adds, without waiting or allocating; any thread
/// may look at it meanwhile.
class Histogram {
 public:
  void add(std::int64_t span) {
    const auto value = static_cast<std::uint64_t>(span > 0 ? span : 0);
    raise(classes_[index(value)], 1);
    raise(count_, 1);
    raise(sum_, value);
    if (value > highest_.load(std::memory_order_relaxed)) highest_.store(value, std::memory_order_relaxed);
    if (value < lowest_.load(std::memory_order_relaxed)) lowest_.store(value, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t highest() const { return highest_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t lowest() const { return count() > 0 ? lowest_.load(std::memory_order_relaxed) : 0; }

  [[nodiscard]] std::uint64_t mean() const { return count() > 0 ? sum_.load(std::memory_order_relaxed) / count() : 0; }

  /// take(longest, spans) for each class that holds some: the upper end of the class, at most the highest span.
  template <class Take>
  void for_each_class(Take&& take) const {
    for (std::size_t i = 0; i < classes_.size(); ++i) {
      const std::uint64_t spans = classes_[i].load(std::memory_order_relaxed);
      if (spans > 0) take(std::min(upper_end(i), highest()), spans);
    }
  }

  /// Not exceeded by this share of the spans: the upper end of its class, at most the highest span.
  [[nodiscard]] std::uint64_t quantile(double share) const {
    const double wanted = share * static_cast<double>(count());
    std::uint64_t passed = 0;
    for (std::size_t i = 0; i < classes_.size(); ++i) {
      passed += classes_[i].load(std::memory_order_relaxed);
      if (passed > 0 && static_cast<double>(passed) >= wanted) {
        return std::min(upper_end(i), highest());
      }
    }
    return highest();
  }

 private:
  static constexpr unsigned sub_bits = 5;

  static void raise(std::atomic<std::uint64_t>& counter, std::uint64_t by) {
    counter.store(counter.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
  }
  [[nodiscard]] static std::size_t index(std::uint64_t value) {
    if (value < (1U << sub_bits)) return static_cast<std::size_t>(value);
    const auto shift = static_cast<unsigned>(std::bit_width(value)) - sub_bits - 1;
    return static_cast<std::size_t>(((shift + 1U) << sub_bits) + (value >> shift) - (1U << sub_bits));
  }
  [[nodiscard]] static std::uint64_t upper_end(std::size_t index) {
    if (index < (1U << sub_bits)) return index;
    const std::size_t shift = (index >> sub_bits) - 1;
    return (((index & ((1U << sub_bits) - 1)) + (1U << sub_bits) + 1) << shift) - 1;
  }

  std::array<std::atomic<std::uint64_t>, (64 - sub_bits + 1) << sub_bits> classes_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t> sum_{0};
  std::atomic<std::uint64_t> highest_{0};
  std::atomic<std::uint64_t> lowest_{~std::uint64_t{0}};
};

}  // namespace firmware::controller
