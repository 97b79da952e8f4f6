// One run of rig_controller, from its options to its exit status.
#pragma once

#include "firmware/controller/devices/options.hpp"

namespace firmware::controller {

/// What the exit status says; 0 to 5 as rigtwin's.
enum class Status : int {
  done = 0,
  wrong_usage = 2,
  unfit_input = 3,
  cannot_write = 4,
  internal = 5,
  refused = 6,
  safe_stop = 7
};

/// Prints what there is to say; the last line says how it ended.
[[nodiscard]] Status run(const Options& options);

}  // namespace firmware::controller
