// Names of effects and lists of them, in words.
#pragma once

#include <string>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"

namespace host_sim::identification {

/// The name of an effect; of a sensor with its channel: "… of F".
[[nodiscard]] std::string words(const firmware::PlacedEffect& effect);

/// "a, b and c"
[[nodiscard]] std::string joined(const std::vector<std::string>& list);

}  // namespace host_sim::identification
