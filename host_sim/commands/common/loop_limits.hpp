// The delay and the gain that a controller may allow its loop: what `rigtwin stability --write-limits` writes.
#pragma once

#include "firmware/description/rig_description.hpp"

namespace host_sim {

/// Sample age and computation that the loop may have on top of the delays that the description states [s]: four fifths
/// of the way to the border of the sampled loop, for every number of ducts that the run opens. Where the delay of the
/// machine varies, from its longest: swing and jitter above the mean.
///
/// With [compensation] the compensated loop decides. It must be stable at every delay of samples and computation from
/// none to the border, since a compensation that assumes more delay than there is makes a loop unstable too.
///
/// The fifth is for what the description does not know; at half of it (0.9) the slowest decay would halve, at twice
/// (0.6) few rigs would be left. InputError where a loop is not stable at every delay of its range, or nothing is left.
[[nodiscard]] double allowed_delay(const firmware::RigDescription& description);

/// Factor on the force that the loop may have beside that delay: four fifths of the way from 1 to the border, for every
/// number of ducts that the run opens. A loop that has both is stable: the border is the smaller one of that at the
/// described delays and that at the longest, samples and computation taking `allowed_delay` and the machine its farthest
/// swing and jitter; with [compensation], which may lead by too much, also that without any delay of samples and
/// computation. 100: no border below.
[[nodiscard]] double allowed_gain(const firmware::RigDescription& description, double allowed_delay);

}  // namespace host_sim
