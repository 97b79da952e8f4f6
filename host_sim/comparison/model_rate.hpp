// A recording at a rate at which models step.
#pragma once

#include <cstddef>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim {

/// [s] The longest step of a simulation. Between samples the input is a cubic whose velocity has an error of (ωh)⁴/30:
/// 4e-5 at 30 Hz and this step. Half: 3e-6, twice the time. Twice: 7e-4, and 3 % at 5 ms, which passes for an effect.
inline constexpr double longest_model_step = 1e-3;

/// [s] The same of a rig in a recording. A component_bench moves as it is recorded, with nothing above half of the rate
/// f, so (ωh)⁴/30 is the same 4e-5 at ω = π f:
///
///   (1)  h = max(longest_model_step, longest_model_step · 2 · 30 Hz / f)
///
/// Of a car its natural frequencies decide, whatever the rate; a command that is stepped has all frequencies, and each
/// step of it would take h.
[[nodiscard]] double longest_step(model::RigKind kind, const firmware::Recording& recording);

/// Model steps for each sample of a recording, so that none is longer than `longest` by more than 5 %. `longest` is
/// longest_model_step at least; the loop of a hil rig may be slower, which is no error of the simulation.
[[nodiscard]] std::size_t model_steps_per_sample(double sample_period, double longest = longest_model_step);

/// Whether a command is a staircase, held between its steps: most of its changes have none beside them. What a spectrum
/// makes of such a step between samples swings by 9 % of it before it comes.
[[nodiscard]] bool is_stepped(const std::vector<double>& command);

/// The recording with so many samples for each one. Those between are interpolated (signal/interpolation.hpp); ducts,
/// and an x_cmd that is stepped, keep their position. What lies beside a sample that was not recorded was not recorded
/// either.
[[nodiscard]] firmware::Recording interpolated(const firmware::Recording& recording, std::size_t factor);

}  // namespace host_sim
