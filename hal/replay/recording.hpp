// What a replay plays, and what it keeps.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "hal/sensor_source.hpp"
#include "hal/time.hpp"

namespace hal::replay {

/// One channel of a recording. No values: the channel is not fitted.
struct Column {
  std::span<const double> values{};
  /// When each value was sampled; empty: at the row's time. A stamp `never` is a sample that was missing.
  std::span<const Time> taken{};
};

/// An interlock that opened, and when; it stays open.
struct Opened {
  Time time = never;
  std::size_t interlock = 0;  ///< below Interlocks::capacity
};

/// An output that did not take what was written, from a time on.
struct Refusal {
  enum class Output : unsigned char { command, valves, heartbeat, enable };
  Time from = never;  ///< never: none
  Output output = Output::command;
};

/// A recording in the caller's memory: hal reads no files. A value that is not finite is delivered as it is.
struct Recording {
  std::span<const Time> time{};  ///< when each row was read; rising
  std::array<Column, channel_capacity> columns{};
  Time stop_pressed = never;  ///< when the stop button was pressed, if it was
  bool drive_enable = false;  ///< the recorded rig had a drive enable
  std::span<const Opened> interlocks_opened{};
  Refusal refusal{};
  Time suspended = never;  ///< the machine was suspended just before this time

  /// What is wrong with the recording, or an empty text.
  [[nodiscard]] std::string_view check() const;
};

/// Something that the program wrote, and when.
template <class T>
struct Written {
  Time time{};
  T value{};
};

/// Keeps what is written, in order, in storage of the caller; what does not fit is counted.
template <class T>
class Track {
 public:
  Track() = default;
  explicit Track(std::span<Written<T>> storage) : storage_(storage) {}

  void keep(Time time, const T& value) {
    if (size_ < storage_.size()) {
      storage_[size_++] = {time, value};
    } else {
      ++lost_;
    }
  }

  [[nodiscard]] std::span<const Written<T>> written() const { return storage_.first(size_); }
  [[nodiscard]] std::size_t lost() const { return lost_; }

 private:
  std::span<Written<T>> storage_{};
  std::size_t size_ = 0;
  std::size_t lost_ = 0;
};

}  // namespace hal::replay
