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

/// What led from ready or running to safe.
enum class Reason : unsigned char {
  none,                ///< no run has ended yet
  reference_ended,     ///< orderly: the run is over
  stop_requested,      ///< orderly: stop() was called
  stop_button,         ///< pressed
  stop_button_lost,    ///< it cannot be read: taken for pressed
  sensors_lost,        ///< the source is disconnected or refuses
  sample_missing,      ///< no sample of a channel, too often in a row
  sample_not_finite,   ///< NaN or infinite, too often in a row
  sample_clipped,      ///< at or beyond the measuring range, too often in a row
  sample_stale,        ///< too old, or stamped in the future, too often in a row
  force,               ///< a measured force beyond the limit
  stroke,              ///< a command beyond the stroke
  speed,               ///< a command faster than the limit for too long
  energy,              ///< a hil interface that feeds in more than the damping takes: the loop grows
  command_not_finite,  ///< a command that is no number
  command_failed,      ///< the drive did not take a command
  valves_failed,       ///< the valves did not take their openings
  heartbeat_failed,    ///< the watchdog cannot be reached
  late,                ///< too many late periods
  following_error,     ///< the measured position is not where the machine should be, for too long
  measured_stroke,     ///< a measured position beyond its limit
  measured_speed,      ///< the measured position moves faster than its limit
  sensor_frozen,       ///< a channel shows the same value while the rig moves
  acceleration,        ///< a command that accelerates more than the limit for too long
  growth,              ///< a hil interface that drives the car outwards: the loop diverges
  gap,                 ///< one period began far too late
};

[[nodiscard]] constexpr std::string_view name(Reason reason) {
  constexpr std::array<std::string_view, 26> names{"none",
                                                   "reference_ended",
                                                   "stop_requested",
                                                   "stop_button",
                                                   "stop_button_lost",
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
                                                   "late",
                                                   "following_error",
                                                   "measured_stroke",
                                                   "measured_speed",
                                                   "sensor_frozen",
                                                   "acceleration",
                                                   "growth",
                                                   "gap"};
  return names[static_cast<std::size_t>(reason)];
}

/// True for what should not happen in a run; its orderly end is no fault.
[[nodiscard]] constexpr bool is_fault(Reason reason) { return reason > Reason::stop_requested; }

/// The end of a run: what, where, by how much, when. Kept from the first reason on until the next start.
struct Trip {
  Reason reason = Reason::none;
  std::optional<model::Channel> channel{};  ///< of a sample or force
  double value = 0.0;                       ///< what was seen, in the unit of the limit (of a sample: last value read)
  double limit = 0.0;                       ///< what it was held against
  hal::Time time = hal::never;              ///< of the period that tripped
};

}  // namespace firmware
