// Units and signs that look wrong, before anything is explained with them.
#pragma once

#include <string>
#include <vector>

#include "host_sim/recording.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// A channel that is what the rig should show, times a factor that a unit or a sign makes and no effect does.
struct Slip {
  model::Channel channel;
  double factor;  ///< recorded = factor × SI: ±1000 for millimetres, ±0.001 for kN, −1 for a swapped sign …
};

/// Some seconds from the middle of the recording, against the rig as described driven by the recording's own input:
/// of each channel that follows the simulation (squared correlation above a half) the factor by which it does, where
/// that is a unit's or a sign's. Where most channels share one, it is the input's.
///
/// zdd_r is held against z_r: the mean of z̈ over ±H, weighted by a triangle, is (z(t+H) − 2 z(t) + z(t−H))/H².
/// In a hil rig machine and component are held against x_cmd, then the car against z_r.
[[nodiscard]] std::vector<Slip> slips(const RigDescription& description, const Recording& recording);

/// InputError that names the channels, what they look like, and what to write in [channels]; nothing without slips.
void refuse_slips(const RigDescription& description, const Recording& recording);

}  // namespace host_sim::diagnose
