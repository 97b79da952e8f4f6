// The button that stops the rig.
#pragma once

#include "hal/result.hpp"
#include "hal/time.hpp"

namespace hal {

/// The stop button. A press is latched: also one shorter than a period counts, until release() is called.
///
/// Any fault: the caller takes it for a press. refused: the two contacts of the button contradict each other.
class StopButton {
 public:
  virtual ~StopButton() = default;

  /// True from the first press on, until release().
  [[nodiscard]] Result<bool> pressed() {
    const Result<Level> level = do_read();
    if (!level) return level.fault();
    if (level->pressed && pressed_at_ == never) pressed_at_ = level->since;
    if (level->pressed && !level->one_contact) tested_at_ = level->since;
    return pressed_at_ != never;
  }

  /// When the latched press began, or `never`.
  [[nodiscard]] Time pressed_at() const { return pressed_at_; }

  /// When the last press began that every contact of the button has shown, or `never`: one that is welded shows none.
  [[nodiscard]] Time tested_at() const { return tested_at_; }

  /// Forgets the press; a button that is still held is latched again by the next pressed().
  void release() { pressed_at_ = never; }

 protected:
  struct Level {
    bool pressed = false;      ///< held down now, or pressed at any time since the last read
    Time since = never;        ///< when that press began, on the rig's clock
    bool one_contact = false;  ///< only one of its two contacts has shown it so far
  };

 private:
  virtual Result<Level> do_read() = 0;

  Time pressed_at_ = never;
  Time tested_at_ = never;
};

}  // namespace hal
