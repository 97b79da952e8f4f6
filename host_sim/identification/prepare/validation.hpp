// Validation: which inputs are refused and which channels are left out, before anything is explained.
#pragma once

#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"

namespace host_sim::identification {

/// Checks tolerances and recordings, and removes dead channels:
///
///   tolerance     of a mass, a stiffness or another number that must be positive below 1, of a damping up to 1
///   kind          the channels are those of the rig's kind
///   dead          a channel that never moves is left out of all recordings, with a remark; a dead input is refused
///   missing       a channel that rigs of this kind usually have gives a remark
///   units, signs  see unit_check.hpp
///
/// Returns remarks. InputError in one line for what cannot be judged.
[[nodiscard]] std::vector<std::string> validate(const firmware::RigDescription& description,
                                                const std::vector<firmware::Recording*>& recordings);

}  // namespace host_sim::identification
