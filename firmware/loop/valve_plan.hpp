// Which ducts are open when.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/time.hpp"
#include "hal/valve_bank.hpp"
#include "model/numerics/require.hpp"

namespace firmware {

/// Openings over the time of a run: some from its beginning, then others from given times on.
///
/// A change takes effect at the first sample k with k · period ≥ its time: k is compared in integer nanoseconds, so a
/// time on the grid means exactly that sample.
class ValvePlan {
 public:
  static constexpr std::size_t capacity = 256;

  struct Change {
    hal::Time at{};  ///< since the run began
    hal::Openings open{};
  };

  /// The same openings all the time.
  explicit constexpr ValvePlan(hal::Openings always = {}) : first_(always) {}

  /// `first`, then the changes: see check().
  constexpr ValvePlan(hal::Openings first, std::span<const Change> changes) : first_(first), size_(changes.size()) {
    model::require(check(changes).empty(), "a valve plan that passes its check");
    for (std::size_t i = 0; i < size_; ++i) {
      at_[i] = changes[i].at;
      open_[i] = changes[i].open;
    }
  }

  /// What is wrong with a list of changes, or an empty text.
  [[nodiscard]] static constexpr std::string_view check(std::span<const Change> changes) {
    if (changes.size() > capacity) return "a valve plan holds at most 256 changes";
    for (std::size_t i = 0; i < changes.size(); ++i) {
      if (changes[i].at < hal::Time{}) return "a valve plan changes at times of at least 0 s";
      if (i > 0 && changes[i].at <= changes[i - 1].at) return "the times of a valve plan rise";
    }
    return {};
  }

  /// True when no opening of the plan needs more than the first `installed` ducts.
  [[nodiscard]] constexpr bool within(std::size_t installed) const {
    bool fits = first_.within(installed);
    for (std::size_t i = 0; i < size_; ++i) fits = fits && open_[i].within(installed);
    return fits;
  }

  /// Openings at a time since the run began, by bisection: nine comparisons for a full plan.
  [[nodiscard]] constexpr hal::Openings at(hal::Time since_start) const {
    std::size_t passed = 0;  // changes before this one have taken place
    std::size_t end = size_;
    while (passed < end) {
      const std::size_t middle = passed + (end - passed) / 2;
      if (at_[middle] <= since_start) {
        passed = middle + 1;
      } else {
        end = middle;
      }
    }
    return passed == 0 ? first_ : open_[passed - 1];
  }

 private:
  hal::Openings first_;
  std::size_t size_ = 0;
  std::array<hal::Time, capacity> at_{};  ///< side by side: 9 bytes a change, and a search stays in these
  std::array<hal::Openings, capacity> open_{};
};

}  // namespace firmware
