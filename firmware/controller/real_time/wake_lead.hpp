// How long before a period its thread wakes up.
#pragma once

#include "hal/time.hpp"

namespace firmware::controller {

/// A span that is too short once in ten thousand times: raised by a step when it was, lowered by a 9999th of it when
/// not.
class QuantileTracker {
 public:
  constexpr QuantileTracker(hal::Time first, hal::Time least, hal::Time most, hal::Time step)
      : span_(first), least_(least), most_(most), step_(step) {}

  constexpr void follow(bool too_short) {
    span_ = too_short ? span_ + step_ : span_ - hal::nanoseconds(step_.ns / 9999);
    if (span_ < least_) span_ = least_;
    if (span_ > most_) span_ = most_;
  }
  [[nodiscard]] constexpr hal::Time span() const { return span_; }

 private:
  hal::Time span_, least_, most_, step_;
};

/// Wakes up early enough to warm the caches, and hardly earlier: what it waits for the instant it does not sleep.
///
///   wake up at  due − early()      early: a warm-up and the machine's wake-up latency, of 9999 periods in 10 000
///   warm up where there is time    a warm-up's own time, of 9999 in 10 000
///   again while there is           so that what others do in the meantime is mended
class WakeLead {
 public:
  explicit constexpr WakeLead(hal::Time most)
      : early_(most < hal::microseconds(20) ? most : hal::microseconds(20), hal::Time{}, most, hal::microseconds(10)),
        duration_(hal::microseconds(10), hal::microseconds(5), most + hal::microseconds(10), hal::microseconds(2)) {}

  [[nodiscard]] constexpr hal::Time early() const { return early_.span(); }

  /// After the sleep: warms the caches over and over while there is time. left(): how long until the period is due,
  /// less than 0 after it.
  template <class Left, class WarmUp>
  constexpr void use(Left&& left, WarmUp&& warm_up) {
    hal::Time rest = left();
    const bool time = rest >= duration_.span();
    early_.follow(!time);
    while (rest >= duration_.span()) {
      warm_up();
      rest = left();
    }
    duration_.follow(time && rest < hal::Time{});
  }

 private:
  QuantileTracker early_;
  QuantileTracker duration_;
};

}  // namespace firmware::controller
