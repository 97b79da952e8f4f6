// What a diagnosis while the rig runs says, as JSON (host_sim/schemas/live.json).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_sim/live/live_diagnosis.hpp"

namespace host_sim::live {

[[nodiscard]] nlohmann::ordered_json to_json(const Finding& finding);

/// Everything so far. `stop`: what was asked of the controller and what it answered; empty: nothing.
[[nodiscard]] nlohmann::ordered_json to_json(const Progress& progress, const std::vector<Finding>& findings,
                                             const std::string& stop);

}  // namespace host_sim::live
