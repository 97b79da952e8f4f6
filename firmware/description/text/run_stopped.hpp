// A simulated run that did not reach its end.
#pragma once

#include <stdexcept>
#include <string_view>

#include "firmware/description/text/input_error.hpp"

namespace firmware {

/// Exit status of a program whose simulated run the firmware stopped before its end; beside ExitStatus.
inline constexpr int exit_status_of_stopped_run = 6;

/// Such a run: what() is the reason, in one line.
class RunStopped : public std::runtime_error {
 public:
  explicit RunStopped(std::string_view reason) : std::runtime_error(one_line(reason)) {}
};

}  // namespace firmware
