// The states of the control program, and what leads from one to another.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace firmware {

/// What the rig is doing.
enum class Mode : unsigned char {
  idle,     ///< nothing is commanded; valves in the safe position
  ready,    ///< the command moves smoothly to where the reference begins
  running,  ///< the rig follows its reference
  safe,     ///< valves in the safe position, the command is brought to a stop and back to rest, and stays there
};

/// What may happen to it.
enum class Event : unsigned char {
  start,        ///< somebody wants a run
  in_position,  ///< the command has reached the beginning of the reference
  trip,         ///< a limit, a fault, the stop button, or the end of the run
  acknowledge,  ///< somebody has seen why, the command is at rest and nothing is wrong any more
};

/// The whole machine. What is not written here does nothing: in particular only `acknowledge` leaves safe, and only by
/// idle and ready is there a way back to running.
[[nodiscard]] constexpr Mode next(Mode mode, Event event) {
  switch (event) {
    case Event::start:
      return mode == Mode::idle ? Mode::ready : mode;
    case Event::in_position:
      return mode == Mode::ready ? Mode::running : mode;
    case Event::trip:
      return mode == Mode::ready || mode == Mode::running ? Mode::safe : mode;
    case Event::acknowledge:
      return mode == Mode::safe ? Mode::idle : mode;
  }
  return Mode::safe;
}

[[nodiscard]] constexpr std::string_view name(Mode mode) {
  constexpr std::array<std::string_view, 4> names{"idle", "ready", "running", "safe"};
  return names[static_cast<std::size_t>(mode)];
}

}  // namespace firmware
