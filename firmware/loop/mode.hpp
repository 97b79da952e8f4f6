// The states of the control program, and what leads from one to another.
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
  checked,      ///< everything that arming looks at is in order
  disarm,       ///< somebody wants the power off
  start,        ///< somebody wants a run
  in_position,  ///< the command has reached the beginning of the reference
  hold,         ///< somebody wants the rig to stand still
  resume,       ///< and to go on
  trip,         ///< a limit, a fault, the stop button, or the end of the run
  acknowledge,  ///< somebody has seen why, the command stands still and nothing is wrong any more
};

/// The whole machine. An event that is not written here changes nothing. Only `acknowledge` leaves safe, and the only
/// way back to running leads through idle, arming, armed and ready.
[[nodiscard]] constexpr Mode next(Mode mode, Event event) {
  switch (event) {
    case Event::arm:
      return mode == Mode::idle ? Mode::arming : mode;
    case Event::checked:
      return mode == Mode::arming ? Mode::armed : mode;
    case Event::disarm:
      return mode == Mode::armed ? Mode::idle : mode;
    case Event::start:
      return mode == Mode::armed ? Mode::ready : mode;
    case Event::in_position:
      return mode == Mode::ready ? Mode::running : mode;
    case Event::hold:
      return mode == Mode::running ? Mode::holding : mode;
    case Event::resume:
      return mode == Mode::holding ? Mode::running : mode;
    case Event::trip:
      return Mode::safe;
    case Event::acknowledge:
      return mode == Mode::safe ? Mode::idle : mode;
  }
  return Mode::safe;
}

/// True where the loop leads the drive: every limit holds.
[[nodiscard]] constexpr bool leads_drive(Mode mode) { return mode != Mode::idle && mode != Mode::safe; }

/// True where a run is under way: its rows are those of a recording.
[[nodiscard]] constexpr bool in_run(Mode mode) { return mode == Mode::running || mode == Mode::holding; }

[[nodiscard]] constexpr std::string_view name(Mode mode) {
  constexpr std::array<std::string_view, 7> names{"idle", "arming", "armed", "ready", "running", "holding", "safe"};
  return names[static_cast<std::size_t>(mode)];
}

}  // namespace firmware
