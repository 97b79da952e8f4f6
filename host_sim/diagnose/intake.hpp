// What is refused, and what is left out, before anything is explained.
#pragma once

#include <string>
#include <vector>

#include "host_sim/recording.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// Recordings as a user brings them become recordings that can be explained:
///
///   tolerance     of a mass, a stiffness or another number that must be positive below 1, of a damping up to 1
///   kind          the recording has the channels of the rig's kind, and none that only another kind has
///   dead          a channel that never moves is left out of all recordings, and said; a dead input is refused
///   missing       a channel that rigs of this kind usually have is said
///   units, signs  see suspicion.hpp
///
/// Returns remarks. InputError in one line for what cannot be judged.
[[nodiscard]] std::vector<std::string> take_in(const RigDescription& description,
                                               const std::vector<Recording*>& recordings);

}  // namespace host_sim::diagnose
