// The states of the control program, what leads from one to another, and what that does to the drive's power.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace firmware {

/// What the rig is doing.
enum class Mode : unsigned char {
  idle,     ///< the drive has no power; valves in the safe position
  arming,   ///< checks, power on, force tared, a small probe of the signs
  armed,    ///< the drive has power and holds its position
  ready,    ///< the command moves smoothly to where the reference begins
  running,  ///< the rig follows its reference
  holding,  ///< the reference slows down and stands still, the loop stays closed
  safe,     ///< valves in the safe position; the command is brought to a stop, and back to rest if that is safe
};

/// What may happen to it.
enum class Event : unsigned char {
  arm,          ///< somebody wants power on the drive
  compared,     ///< what is looked at before power is in order
  checked,      ///< everything that arming looks at is in order
  disarm,       ///< somebody wants the power off
  start,        ///< somebody wants a run
  in_position,  ///< the command has reached the beginning of the reference
  hold,         ///< somebody wants the rig to stand still
  resume,       ///< and to go on
  trip,         ///< a reason after which a drive with power returns to rest
  halt,         ///< a reason after which it brakes, stays where it stopped and has no power
  rest,         ///< somebody wants it back at rest
  arrived,      ///< it is there
  acknowledge,  ///< somebody has seen why, the command stands still and nothing is wrong any more
};

inline constexpr Event last_event = Event::acknowledge;

/// What an event does to the drive's enable.
enum class Power : unsigned char { keep, give, take };

/// One line of the controller's table.
struct Transition {
  Mode from;
  Event event;
  Mode to;
  Power power;
};

/// The whole machine. An event that is not written here changes nothing. Only `acknowledge` leaves safe, and the only
/// way back to running leads through idle, arming, armed and ready. Power is given in two lines: after the comparison
/// of an arming, and at a person's `rest`. A drive without power gets none by a trip: there it is a halt (event_of()).
inline constexpr auto transitions = std::to_array<Transition>({
    {Mode::idle, Event::arm, Mode::arming, Power::keep},
    {Mode::arming, Event::compared, Mode::arming, Power::give},
    {Mode::arming, Event::checked, Mode::armed, Power::keep},
    {Mode::armed, Event::disarm, Mode::idle, Power::take},
    {Mode::armed, Event::start, Mode::ready, Power::keep},
    {Mode::ready, Event::in_position, Mode::running, Power::keep},
    {Mode::running, Event::hold, Mode::holding, Power::keep},
    {Mode::holding, Event::resume, Mode::running, Power::keep},
    {Mode::arming, Event::trip, Mode::safe, Power::keep},
    {Mode::armed, Event::trip, Mode::safe, Power::keep},
    {Mode::ready, Event::trip, Mode::safe, Power::keep},
    {Mode::running, Event::trip, Mode::safe, Power::keep},
    {Mode::holding, Event::trip, Mode::safe, Power::keep},
    {Mode::idle, Event::halt, Mode::safe, Power::take},
    {Mode::arming, Event::halt, Mode::safe, Power::take},
    {Mode::armed, Event::halt, Mode::safe, Power::take},
    {Mode::ready, Event::halt, Mode::safe, Power::take},
    {Mode::running, Event::halt, Mode::safe, Power::take},
    {Mode::holding, Event::halt, Mode::safe, Power::take},
    {Mode::safe, Event::halt, Mode::safe, Power::take},
    {Mode::safe, Event::rest, Mode::safe, Power::give},
    {Mode::safe, Event::arrived, Mode::safe, Power::take},
    {Mode::safe, Event::acknowledge, Mode::idle, Power::take},
});

/// The line for an event in a state; one that changes nothing where none is written.
[[nodiscard]] constexpr Transition transition(Mode mode, Event event) {
  for (const Transition& line : transitions) {
    if (line.from == mode && line.event == event) return line;
  }
  return {mode, event, mode, Power::keep};
}

[[nodiscard]] constexpr Mode next(Mode mode, Event event) { return transition(mode, event).to; }

/// What a person or the program may ask for.
enum class Request : unsigned char { start, stop, acknowledge, arm, disarm, hold, resume, rest, end };

inline constexpr Request last_request = Request::end;

/// What a request needs besides its state.
namespace need {
inline constexpr unsigned nothing = 0;
inline constexpr unsigned standing = 1;   ///< no power, and nothing moves
inline constexpr unsigned no_hazard = 2;  ///< button up, interlocks closed, nothing wrong that still lasts
inline constexpr unsigned proven = 4;     ///< arming has passed, and nothing has happened since that takes an arming
inline constexpr unsigned moving = 8;     ///< the way back to rest is under way
}  // namespace need

/// A request that is not written here for a state is refused there.
struct RequestRule {
  Request request;
  Mode mode;
  Event event;  ///< trip: halt where the drive has no power
  unsigned needs;
};

inline constexpr auto request_rules = std::to_array<RequestRule>({
    {Request::arm, Mode::idle, Event::arm, need::nothing},
    {Request::disarm, Mode::armed, Event::disarm, need::nothing},
    {Request::start, Mode::armed, Event::start, need::nothing},
    {Request::hold, Mode::running, Event::hold, need::nothing},
    {Request::resume, Mode::holding, Event::resume, need::nothing},
    {Request::stop, Mode::idle, Event::trip, need::nothing},
    {Request::stop, Mode::arming, Event::trip, need::nothing},
    {Request::stop, Mode::armed, Event::trip, need::nothing},
    {Request::stop, Mode::ready, Event::trip, need::nothing},
    {Request::stop, Mode::running, Event::trip, need::nothing},
    {Request::stop, Mode::holding, Event::trip, need::nothing},
    {Request::stop, Mode::safe, Event::halt, need::moving},
    {Request::end, Mode::idle, Event::trip, need::nothing},
    {Request::end, Mode::arming, Event::trip, need::nothing},
    {Request::end, Mode::armed, Event::trip, need::nothing},
    {Request::end, Mode::ready, Event::trip, need::nothing},
    {Request::end, Mode::running, Event::trip, need::nothing},
    {Request::end, Mode::holding, Event::trip, need::nothing},
    {Request::rest, Mode::safe, Event::rest, need::standing | need::no_hazard | need::proven},
    {Request::acknowledge, Mode::safe, Event::acknowledge, need::standing | need::no_hazard},
});

/// The rule for a request in a state, or nothing: it is refused there.
[[nodiscard]] constexpr const RequestRule* rule_of(Request request, Mode mode) {
  for (const RequestRule& rule : request_rules) {
    if (rule.request == request && rule.mode == mode) return &rule;
  }
  return nullptr;
}

/// True where the loop leads the drive: every limit holds.
[[nodiscard]] constexpr bool leads_drive(Mode mode) { return mode != Mode::idle && mode != Mode::safe; }

/// True where the second stage of a power unit is on: behind all checks of an arming, and not in safe.
[[nodiscard]] constexpr bool has_high_pressure(Mode mode) { return leads_drive(mode) && mode != Mode::arming; }

/// True where a run is under way: its rows are those of a recording.
[[nodiscard]] constexpr bool in_run(Mode mode) { return mode == Mode::running || mode == Mode::holding; }

[[nodiscard]] constexpr std::string_view name(Mode mode) {
  constexpr std::array<std::string_view, 7> names{"idle", "arming", "armed", "ready", "running", "holding", "safe"};
  return names[static_cast<std::size_t>(mode)];
}

[[nodiscard]] constexpr std::string_view name(Event event) {
  constexpr std::array<std::string_view, 13> names{"arm",         "compared", "checked",    "disarm", "start",
                                                   "in_position", "hold",     "resume",     "trip",   "halt",
                                                   "rest",        "arrived",  "acknowledge"};
  return names[static_cast<std::size_t>(event)];
}

[[nodiscard]] constexpr std::string_view name(Request request) {
  constexpr std::array<std::string_view, 9> names{"start", "stop",   "acknowledge", "arm", "disarm",
                                                  "hold",  "resume", "rest",        "end"};
  return names[static_cast<std::size_t>(request)];
}

}  // namespace firmware
