// Several rigs simulated at once over one recording, side by side in vector registers.
#pragma once

#include <cstddef>
#include <vector>

#include "host_sim/comparison/simulation.hpp"

namespace host_sim {

/// One of the simulations: a rig, the state in which it begins, what drives it, and how the rig changes meanwhile: in
/// its numbers alone. nullptr: it does not.
struct SideBySideRig {
  const model::RigParameters<double>* rig;
  const InitialState* start;
  const SimulationInput* input;
  const RigVariation* variation = nullptr;
};

/// The number of rigs that one simulation steps together.
enum class LaneUse : unsigned char {
  automatic,  ///< what the processor has
  one,        ///< one after the other
  four,       ///< needs AVX2
  eight,      ///< needs AVX-512
};

/// True if this processor and this build have registers of that width.
[[nodiscard]] bool has_lanes(LaneUse use);

/// True if two rigs may be simulated side by side: they have the same parts and effects and differ in values only.
[[nodiscard]] bool alike(const model::RigParameters<double>& a, const model::RigParameters<double>& b);

/// simulate() of each rig, bit for bit. The rigs have no effects of sensors; the inputs have one period and length, and
/// the same ducts and F_act. Rigs that are not alike are simulated in groups that are, and a group too small to be
/// worth it one after the other. `channels`: those of response_channels() that are wanted.
[[nodiscard]] std::vector<Response> simulate_side_by_side(const std::vector<SideBySideRig>& rigs, std::size_t samples,
                                                          int substeps, const std::vector<model::Channel>& channels,
                                                          LaneUse use = LaneUse::automatic);

}  // namespace host_sim
