// The methods that the benchmark compares: the problem's own controller, and the compensators of firmware/loop.
#pragma once

#include <vector>

#include "tests/bench/rths/problem.hpp"

namespace rths {

/// All of them, with what they assume of the nominal plant:
///
///   none                        the wanted displacement is the command
///   baseline                    lead and PI controller of the problem
///   baseline_polynomial         polynomial of third degree over the 4.64 ms that the baseline leaves
///   polynomial                  over the plant's own delay, first degree
///   inverse_2, inverse          the exact plant's inverse up to ẍ, up to x⃛ and with the half step of the held command
///   adaptive_time_series_2      coefficients up to ẍ, as in the literature
///   adaptive_time_series        up to x⃛
///   feedforward_feedback        inverse and LQG on the tracking error
///   smith                       with the specimen's stiffness and damping
///   virtual_damping, adaptive_virtual_damping
///   adaptive_time_series_force  and the force extrapolated over the late step and the half step that it is held
[[nodiscard]] std::vector<Method> methods();

}  // namespace rths
