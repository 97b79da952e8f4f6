// Two contacts of one stop button, compared.
#pragma once

#include "hal/time.hpp"

namespace hal {

/// Both contacts of a stop button open at one press. Contacts that differ for longer than `tolerance` say that one of
/// them is broken: welded, or bridged by a short circuit, which a single contact cannot show.
///
/// tolerance 0.5 s: a hand opens both contacts of a button within some 50 ms, and IEC 60947-5-5 buttons snap. Half of
/// it would still suffice; twice would only leave a broken contact unseen for longer, while the other one already acts.
class StopChannels {
 public:
  static constexpr Time tolerance = milliseconds(500);

  /// The levels now, once a period. False: they have differed for too long.
  [[nodiscard]] bool agree(bool first_pressed, bool second_pressed, Time now) {
    if (first_pressed == second_pressed) {
      differ_since_ = never;
    } else if (differ_since_ == never) {
      differ_since_ = now;
    }
    return differ_since_ == never || now - differ_since_ <= tolerance;
  }

  /// Whether contacts that opened last at these times, or `never`, did so at one press.
  [[nodiscard]] static constexpr bool one_press(Time first, Time second) {
    if (first == never || second == never) return false;
    return first < second ? second - first <= tolerance : first - second <= tolerance;
  }

 private:
  Time differ_since_ = never;
};

}  // namespace hal
