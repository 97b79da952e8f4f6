// verdict.json
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host_sim/identification/assess/diagnosis_result.hpp"

namespace host_sim::identification {

/// The diagnosis as other people's scripts read it.
[[nodiscard]] nlohmann::ordered_json to_json(const Diagnosis& diagnosis);

}  // namespace host_sim::identification
