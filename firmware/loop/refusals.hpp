// All that is wrong with a rig that shall be armed.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "firmware/loop/common/trip.hpp"

namespace firmware {

/// The failed checks of an arming, in the order in which they were looked at. The loop's thread writes; any thread may
/// read. Each reason stands once for a channel or an interlock.
class Refusals {
 public:
  static constexpr std::size_t most = 16;  ///< further ones are left out

  void clear() { count_.store(0, std::memory_order_release); }
  void add(const Trip& trip);

  [[nodiscard]] std::size_t size() const { return count_.load(std::memory_order_acquire); }
  /// Value and limit have seven digits; the time is not kept.
  [[nodiscard]] Trip at(std::size_t place) const;

 private:
  /// Of 32 bits each: what a microcontroller reads and writes at once.
  struct Entry {
    std::atomic<std::uint32_t> what{0};  ///< reason, channel + 1, interlock + 1, eight bits each
    std::atomic<float> value{0.0F}, limit{0.0F};
  };
  std::array<Entry, most> entries_{};
  std::atomic<std::uint32_t> count_{0};
};

}  // namespace firmware
