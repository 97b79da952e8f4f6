// What goes wrong in a simulated rig, and when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/result.hpp"
#include "hal/sensor_source.hpp"
#include "hal/time.hpp"

namespace hal::simulated {

/// From a point in time up to, not including, another.
struct Window {
  Time from = never;
  Time until{std::numeric_limits<std::int64_t>::max()};

  [[nodiscard]] constexpr bool contains(Time t) const { return t >= from && t < until; }
};

/// How many samples late a delayed channel may be.
inline constexpr unsigned delay_capacity = 64;

/// Something wrong with one channel, for the samples taken inside the window.
struct ChannelFault {
  enum class Kind : unsigned char {
    drop,          ///< no sample
    freeze,        ///< the first sample of the window again and again, with its old stamp: the sensor stopped renewing
    delay,         ///< the sample from `delay_samples` earlier, with its old stamp
    not_a_number,  ///< NaN
    spike,         ///< `spike` added
    bit_flip,      ///< one bit of the value turned over: `bit`, or one drawn anew each time
    repeat,  ///< the first value of the window again and again, with new stamps: the converter works, the sensor does not
  };

  Kind kind = Kind::drop;
  std::size_t channel = 0;
  Window window{};
  unsigned delay_samples = 0;  ///< below delay_capacity
  double spike = 0.0;          ///< [unit of the channel]
  int bit = -1;                ///< 0…63 of the 64-bit value, 63 is its sign; −1: drawn
  double probability = 1.0;    ///< share of the samples in the window that are hit, drawn; freeze and repeat always hit
};

/// A device that answers with a fault while the window lasts. A faulty output keeps what it was told before.
struct DeviceFault {
  enum class Device : unsigned char {
    sensors,
    valves,
    command,
    stop_button,
    heartbeat,
    drive_enable,
    interlocks,
    area,
    enable_feedback,
    high_pressure
  };

  Device device = Device::sensors;
  Fault fault = Fault::timeout;
  Window window{};
};

/// The stop button held down during the window.
struct Press {
  enum class Contacts : unsigned char { both, first, second };  ///< which of its contacts open

  Window window{};
  Contacts contacts = Contacts::both;
};

/// An interlock that is open during the window.
struct OpenInterlock {
  std::size_t interlock = 0;
  Window window{};
};

/// The command's converter shows another position than it was told during the window.
struct ReadBackError {
  double offset = 0.0;  ///< [m]
  Window window{};
};

/// The contact that gives the drive power stays on, or off, during the window, whatever its output says: a welded or
/// bridged relay, a broken coil. A watchdog takes the supply behind it.
struct StuckEnable {
  bool on = true;
  Window window{};
};

/// The contact that shows the drive's power shows this during the window.
struct StuckFeedback {
  bool shows = false;
  Window window{};
};

/// The drive does not do what it is told during the window: with its power it goes on at `velocity`, 0: it stands. A
/// seized spool, a lost pilot pressure. Without power it coasts to a stop like any other.
struct StuckDrive {
  Window window{};
  double velocity = 0.0;  ///< [m/s]
};

/// The drive is pushed with this velocity while it has no power: a hand, a load that sinks.
struct Push {
  double velocity = 0.0;  ///< [m/s]
  Window window{};
};

/// The machine that runs the program is suspended for so long at a time; the rig's clock does not count it.
struct Suspension {
  Time at{};
  Time length{};
};

/// Sleeping until a deadline inside the window ends so much later.
struct LateWake {
  Window window{};
  Time by{};
};

/// Everything that goes wrong in a run; several faults of one channel act in the order of the list. The lists belong to
/// the caller and must outlive the rig. Whatever is drawn follows from the seed alone.
struct FaultPlan {
  std::span<const ChannelFault> channels{};
  std::span<const DeviceFault> devices{};
  std::span<const Press> presses{};
  std::span<const OpenInterlock> open_interlocks{};
  std::span<const ReadBackError> read_back_errors{};
  std::span<const LateWake> late_wakes{};
  std::uint64_t seed = 1;
  std::span<const StuckEnable> stuck_enables{};
  std::span<const StuckFeedback> stuck_feedbacks{};
  std::span<const Push> pushes{};
  std::span<const Suspension> suspensions{};
  std::span<const StuckDrive> stuck_drives{};

  /// What is wrong with the plan itself, or an empty text.
  [[nodiscard]] std::string_view check() const;
};

}  // namespace hal::simulated
