// Why a run ended.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/loop/common/mode.hpp"
#include "hal/time.hpp"
#include "model/components/channel.hpp"

namespace firmware {

/// What led to safe. Numbers are on record: new ones come last.
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
  enable_feedback,        ///< the contact that shows the drive's power differs from what is commanded
  motion_without_power,   ///< the measured position moves although the drive has no power
  innovation,             ///< a channel has not answered as the described rig does for long
  arming_off_centre,      ///< the drive stands off the middle and the sign of its position has not been shown
  arming_gain_F,          ///< the force answers the deflection by more than the proven loop bears
  arming_stop_untested,   ///< nobody has pressed the stop button for so long that it must be tried
};

inline constexpr Reason last_reason = Reason::arming_stop_untested;

/// What a reason does to a drive with power.
enum class Reaction : unsigned char {
  returns,  ///< brakes, goes back to rest with power, and loses it there
  holds,    ///< brakes, stays where it stopped, loses its power at once; `rest` may lead it back
  rearms,   ///< the same; power comes back only by a new arming, which compares command and measured position first
  starves,  ///< the same, and no heartbeat until somebody has acknowledged it: the watchdog outside takes the supply
};

struct ReasonRule {
  std::string_view name;
  Reaction reaction;
};

/// One line for each reason, in their order. Held where it stopped is what a drive does whose place or direction is
/// unknown or which somebody wants to stand still. `rearms`: a watchdog outside may have taken the power, the line of
/// the enable is not under control, or a check of arming has failed. `starves`: the power does not go when it is taken.
inline constexpr auto reason_rules = std::to_array<ReasonRule>({
    {"none", Reaction::returns},
    {"reference_ended", Reaction::returns},
    {"stop_requested", Reaction::returns},
    {"stop_button", Reaction::holds},
    {"stop_button_lost", Reaction::holds},
    {"stop_channels", Reaction::holds},
    {"interlock", Reaction::holds},
    {"interlocks_lost", Reaction::holds},
    {"sensors_lost", Reaction::returns},
    {"sample_missing", Reaction::returns},
    {"sample_not_finite", Reaction::returns},
    {"sample_clipped", Reaction::returns},
    {"sample_stale", Reaction::returns},
    {"force", Reaction::returns},
    {"stroke", Reaction::returns},
    {"speed", Reaction::returns},
    {"energy", Reaction::returns},
    {"command_not_finite", Reaction::returns},
    {"command_failed", Reaction::holds},
    {"valves_failed", Reaction::rearms},
    {"heartbeat_failed", Reaction::rearms},
    {"enable_failed", Reaction::rearms},
    {"arming_read_back", Reaction::rearms},
    {"arming_position", Reaction::rearms},
    {"arming_not_at_rest", Reaction::rearms},
    {"arming_preload", Reaction::rearms},
    {"arming_noise", Reaction::rearms},
    {"arming_polarity_x_act", Reaction::rearms},
    {"arming_polarity_F", Reaction::rearms},
    {"late", Reaction::returns},
    {"following_error", Reaction::holds},
    {"measured_stroke", Reaction::holds},
    {"measured_speed", Reaction::holds},
    {"sensor_frozen", Reaction::returns},
    {"acceleration", Reaction::returns},
    {"growth", Reaction::returns},
    {"gap", Reaction::rearms},
    {"compensation", Reaction::returns},
    {"enable_feedback", Reaction::starves},
    {"motion_without_power", Reaction::starves},
    {"innovation", Reaction::returns},
    {"arming_off_centre", Reaction::rearms},
    {"arming_gain_F", Reaction::rearms},
    {"arming_stop_untested", Reaction::rearms},
});
static_assert(reason_rules.size() == static_cast<std::size_t>(last_reason) + 1, "a line for each reason");

[[nodiscard]] constexpr std::string_view name(Reason reason) {
  return reason_rules[static_cast<std::size_t>(reason)].name;
}

[[nodiscard]] constexpr Reaction reaction(Reason reason) {
  return reason_rules[static_cast<std::size_t>(reason)].reaction;
}

/// True for what should not happen in a run; its orderly end is no fault.
[[nodiscard]] constexpr bool is_fault(Reason reason) { return reason > Reason::stop_requested; }

/// True for a stop that somebody has pressed, or may have: it acts in every state.
[[nodiscard]] constexpr bool is_stop(Reason reason) {
  return reason == Reason::stop_button || reason == Reason::stop_button_lost || reason == Reason::stop_channels;
}

/// True where power comes back only by a new arming.
[[nodiscard]] constexpr bool loses_power(Reason reason) { return reaction(reason) >= Reaction::rearms; }

/// True where the drive brakes, stays where it stopped, and loses its enable at once. Otherwise it keeps the enable
/// until it has returned to rest.
[[nodiscard]] constexpr bool takes_power(Reason reason) { return reaction(reason) != Reaction::returns; }

/// True where the heartbeat ends with it.
[[nodiscard]] constexpr bool takes_heartbeat(Reason reason) { return reaction(reason) == Reaction::starves; }

/// What a reason does in a state. Nothing on the way to safety gives power: a drive without it stays where it is. A
/// force beyond its limit in a slow motion means that the drive meets something: it does not go back through it.
[[nodiscard]] constexpr Event event_of(Reason reason, Mode mode, bool powered) {
  const bool slow = !in_run(mode);
  const bool holds = takes_power(reason) || !powered || mode == Mode::idle || mode == Mode::safe;
  return holds || (slow && reason == Reason::force) ? Event::halt : Event::trip;
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

/// A hazard that a guard has found in a channel. Written out at each place it would take a kilobyte of a board's flash.
[[nodiscard]] std::optional<Trip> hazard_of(Reason reason, model::Channel channel, double value, double limit,
                                            hal::Time now);

}  // namespace firmware
