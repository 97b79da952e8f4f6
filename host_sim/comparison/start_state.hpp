// The state in which a recording begins.
#pragma once

#include <vector>

#include "host_sim/comparison/simulation.hpp"

namespace host_sim {

/// True if the recording begins at rest: the first 10 samples of every channel stay within 5 % of the channel's rms of
/// the value that a resting rig has. Half of it would call a recording with a noisy sensor moving, which costs six free
/// parameters; twice would call a slow motion rest, which leaves a decaying error of a tenth of the signal.
[[nodiscard]] bool begins_at_rest(const model::RigParameters<double>& rig, const SimulationInput& input,
                                  const firmware::Recording& recording);

/// Places in InitialState that a recording does not tell: of a car all but what a prescribed wheel or a fixed base does,
/// of ducts the fluid; of a bench the machine, where the first x_act is away from x_cmd by more than that 5 %.
[[nodiscard]] std::vector<int> free_states(const model::RigParameters<double>& rig, const SimulationInput& input,
                                           const firmware::Recording& recording);

/// The state x₀ at the first sample that fits the first 3 s best:
///
///   (1)  min Σ_c Σ_k (measured_ck − simulated_ck(x₀))² / rms(measured_c)²
///
/// over the samples inside their measuring range. The response is nearly linear in the state, so two full Gauss–Newton
/// steps suffice (least_squares/). 3 s are two periods of a body mode of 1.5 Hz.
[[nodiscard]] InitialState estimated_start(const model::RigParameters<double>& rig, const SimulationInput& input,
                                           const firmware::Recording& recording,
                                           const firmware::MeasuringRanges& range = {});

}  // namespace host_sim
