// The input that drives the simulation of a recording, also where the road was not measured.
#pragma once

#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/comparison/simulation.hpp"

namespace host_sim::identification {

/// The input of a recording. A quarter_car takes the first that is recorded:
///
///   z_r    the foot point, as in every simulation
///   z̈_r    the foot point, integrated twice. The drift of the integral moves no channel that is relative or an
///          acceleration, and counts as noise of the input in those that are absolute
///   z̈_w    the wheel, integrated twice, or z_w: the wheel is prescribed (SimulationInput::wheel_prescribed), and
///          suspension and body answer. Nothing below the wheel is simulated
///
/// InputError where none is recorded.
[[nodiscard]] SimulationInput driving_input(const model::RigParameters<double>& rig,
                                            const firmware::Recording& recording);

/// z with δ²z = h² M A from rest, where M = 1 + δ²/12 (input_fusion.hpp), without the mean of A and without its own
/// straight line: neither is known from an acceleration.
[[nodiscard]] std::vector<double> twice_integrated(std::vector<double> acceleration, double period);

/// The motion that samples of the driving channel say: of an acceleration it is integrated twice.
[[nodiscard]] firmware::FootPointMotion motion_of(model::Channel channel, const std::vector<double>& samples,
                                                  double period);

/// One line on an input that stands for the road; empty where the road was measured.
[[nodiscard]] std::string road_remark(const SimulationInput& input);

}  // namespace host_sim::identification
