// A delay line for several rigs side by side.
#pragma once

#include <array>
#include <cstddef>

#include "model/numerics/delay_line.hpp"
#include "model/numerics/lanes.hpp"

namespace model {

/// The delay line of strokes with a delay of its own in each lane, which stays what it was at the start.
template <std::size_t N, std::size_t Capacity>
class DelayLine<Stroke<Lanes<N>>, Capacity, Lanes<N>> {
 public:
  using S = Lanes<N>;
  static constexpr std::size_t longest = Capacity - 4;  ///< [samples]

  void start(const Stroke<S>& value, const S& delay) {
    ring_.fill(value);
    between_samples_ = false;
    std::array<double, N> fraction{};
    for (std::size_t lane = 0; lane < N; ++lane) {
      require(delay[lane] >= 0.0 && delay[lane] <= static_cast<double>(longest), "delay within the capacity");
      const SampleDelay<double> at = split(delay[lane]);
      whole_[lane] = at.whole;
      fraction[lane] = at.fraction;
      between_samples_ = between_samples_ || at.fraction != 0.0;
    }
    fraction_ = S::each([&](std::size_t lane) { return fraction[lane]; });
  }

  void push(const Stroke<S>& newest) {
    newest_ = (newest_ + 1) & mask;
    ring_[newest_] = newest;
  }

  [[nodiscard]] Stroke<S> read(const S& h) const {
    const Stroke<S> newer = gather(0);
    if (!between_samples_) return newer;
    return select(fraction_ == S(0), newer, hermite(gather(1), newer, S(1) - fraction_, h));
  }

  [[nodiscard]] const Stroke<S>& ago(std::size_t samples) const { return ring_[(newest_ - samples) & mask]; }
  [[nodiscard]] Stroke<S>& ago(std::size_t samples) { return ring_[(newest_ - samples) & mask]; }

 private:
  static constexpr std::size_t mask = Capacity - 1;

  /// Of each lane the sample that lies its whole delay, and `more` samples, back.
  [[nodiscard]] RIGTWIN_INLINE Stroke<S> gather(std::size_t more) const {
    return {S::each([&](std::size_t lane) { return ago(whole_[lane] + more).position[lane]; }),
            S::each([&](std::size_t lane) { return ago(whole_[lane] + more).velocity[lane]; })};
  }

  std::array<Stroke<S>, Capacity> ring_{};
  std::array<std::size_t, N> whole_{};
  S fraction_{};
  std::size_t newest_ = 0;
  bool between_samples_ = false;  ///< the delay of some lane is not a whole number
};

}  // namespace model
