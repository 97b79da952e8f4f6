// What the two files for libgpiod have in common.
#pragma once

#include <string>

#include "hal/result.hpp"

namespace hal::linux {

/// "GPIO line 'stop' of chip 'rig-bank'"
[[nodiscard]] std::string place_of(const std::string& chip, const std::string& line);

/// Why a line cannot be had, and what to do: `user` is the program that holds it.
[[nodiscard]] std::string refusal(const std::string& chip, const std::string& line, const std::string& user, int error);

/// What an error of a line that was opened asks of its user.
[[nodiscard]] Fault fault_of(int error);

/// Whether an edge waits in the kernel's queue, without waiting for one. disconnected: the chip is gone.
[[nodiscard]] Result<bool> edge_waits(int descriptor);

}  // namespace hal::linux
