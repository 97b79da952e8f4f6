// Why a run ended.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/time.hpp"
#include "model/channel.hpp"

namespace firmware {

/// What led to safe.
enum class Reason : unsigned char {
  none,                   ///< no run has ended yet
  reference_ended,        ///< orderly: the run is over
  stop_requested,         ///< orderly: stop() was called
  stop_button,            ///< pressed
  stop_button_lost,       ///< it cannot be read: taken for pressed
  stop_channels,          ///< its two contacts differ: one of them is broken
  interlock,              ///< an interlock is open
  interlocks_lost,        ///< they cannot be read: taken for open
  sensors_lost,           ///< the source is disconnected or refuses
  sample_missing,         ///< no sample of a channel, too often in a row
  sample_not_finite,      ///< NaN or infinite, too often in a row
  sample_clipped,         ///< at or beyond the measuring range, too often in a row
  sample_stale,           ///< too old, or stamped in the future, too often in a row
  force,                  ///< a measured force beyond the limit
  stroke,                 ///< a command beyond the stroke
  speed,                  ///< a command faster than the limit for too long
  energy,                 ///< a hil interface that feeds in more than the damping takes: the loop grows
  command_not_finite,     ///< a command that is no number
  command_failed,         ///< the drive did not take a command
  valves_failed,          ///< the valves did not take their openings
  heartbeat_failed,       ///< the watchdog cannot be reached
  enable_failed,          ///< the drive's enable cannot be written
  arming_read_back,       ///< the command's converter does not show what it was told
  arming_position,        ///< the drive is not where the command is
  arming_not_at_rest,     ///< force or position move while they should rest
  arming_preload,         ///< the force at rest is too large to be an offset of its sensor
  arming_noise,           ///< too much noise to tell signs by the probe
  arming_polarity_x_act,  ///< the measured position does not follow the command in sign and size
  arming_polarity_F,      ///< the force does not answer the deflection in sign and size
  late,                   ///< too many late periods
  following_error,        ///< the measured position is not where the machine should be, for too long
  measured_stroke,        ///< a measured position beyond its limit
  measured_speed,         ///< the measured position moves faster than its limit
  sensor_frozen,          ///< a channel shows the same value while the rig moves
  acceleration,           ///< a command that accelerates more than the limit for too long
  growth,                 ///< a hil interface that drives the car outwards: the loop diverges
  gap,                    ///< one period began far too late
  compensation,           ///< the compensation of the machine's delay adds more than it may
};

inline constexpr Reason last_reason = Reason::compensation;

[[nodiscard]] constexpr std::string_view name(Reason reason) {
  constexpr auto names = std::to_array<std::string_view>({"none",
                                                          "reference_ended",
                                                          "stop_requested",
                                                          "stop_button",
                                                          "stop_button_lost",
                                                          "stop_channels",
                                                          "interlock",
                                                          "interlocks_lost",
                                                          "sensors_lost",
                                                          "sample_missing",
                                                          "sample_not_finite",
                                                          "sample_clipped",
                                                          "sample_stale",
                                                          "force",
                                                          "stroke",
                                                          "speed",
                                                          "energy",
                                                          "command_not_finite",
                                                          "command_failed",
                                                          "valves_failed",
                                                          "heartbeat_failed",
                                                          "enable_failed",
                                                          "arming_read_back",
                                                          "arming_position",
                                                          "arming_not_at_rest",
                                                          "arming_preload",
                                                          "arming_noise",
                                                          "arming_polarity_x_act",
                                                          "arming_polarity_F",
                                                          "late",
                                                          "following_error",
                                                          "measured_stroke",
                                                          "measured_speed",
                                                          "sensor_frozen",
                                                          "acceleration",
                                                          "growth",
                                                          "gap",
                                                          "compensation"});
  return names[static_cast<std::size_t>(reason)];
}

/// True for what should not happen in a run; its orderly end is no fault.
[[nodiscard]] constexpr bool is_fault(Reason reason) { return reason > Reason::stop_requested; }

/// True for a stop that somebody has pressed, or may have: it acts in every state.
[[nodiscard]] constexpr bool is_stop(Reason reason) {
  return reason == Reason::stop_button || reason == Reason::stop_button_lost || reason == Reason::stop_channels;
}

/// True where a watchdog outside may have taken the power, or the line of the enable is not under control. Power comes
/// back only by a new arming, which compares command and measured position first.
[[nodiscard]] constexpr bool loses_power(Reason reason) {
  return reason == Reason::heartbeat_failed || reason == Reason::enable_failed || reason == Reason::valves_failed ||
         reason == Reason::gap;
}

/// True where the drive brakes, stays where it stopped, and loses its enable at once. Otherwise it keeps the enable
/// until it has returned to rest.
[[nodiscard]] constexpr bool takes_power(Reason reason) {
  switch (reason) {
    case Reason::interlock:
    case Reason::interlocks_lost:
    case Reason::command_failed:   // what the drive does is unknown
    case Reason::following_error:  // it does not go where it is told
    case Reason::measured_stroke:
    case Reason::measured_speed:
    case Reason::arming_read_back:  // the signs are unknown: a way back may lead away
    case Reason::arming_position:
    case Reason::arming_not_at_rest:
    case Reason::arming_preload:
    case Reason::arming_noise:
    case Reason::arming_polarity_x_act:
    case Reason::arming_polarity_F:
      return true;
    default:
      return is_stop(reason) || loses_power(reason);
  }
}

/// The end of a run: what, where, by how much, when. Kept from the first reason on until the next start.
struct Trip {
  Reason reason = Reason::none;
  std::optional<model::Channel> channel{};  ///< of a sample or force; compensation: x_cmd or F
  double value = 0.0;                       ///< what was seen, in the unit of the limit (of a sample: last value read)
  double limit = 0.0;                       ///< what it was held against
  hal::Time time = hal::never;              ///< of the period that tripped
  std::int8_t interlock = -1;               ///< which interlock was open; −1: none
};

}  // namespace firmware
