// Delay of samples and computation, measured before anything moves.
#pragma once

#include <functional>

#include "hal/clock.hpp"
#include "hal/rig.hpp"
#include "hal/time.hpp"

namespace firmware::controller {

/// P99.9 of the age of the oldest good sample in a frame, over 1000 periods but at most a second, the first of which is
/// due at `first`. Frames without a sample do not count: the control loop finds them.
[[nodiscard]] hal::Time measured_sample_age(const hal::Rig& roles, hal::Time first, hal::Time period);

/// P99.9 of the time of a step, over 1000 steps.
[[nodiscard]] hal::Time measured_computation(const std::function<void()>& step, hal::Clock& machine);

}  // namespace firmware::controller
