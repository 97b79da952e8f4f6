// Stability results as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "host_sim/stability/analysis.hpp"
#include "host_sim/stability/frequency_response.hpp"
#include "host_sim/stability/stability_map.hpp"

namespace host_sim::stability {

[[nodiscard]] nlohmann::ordered_json to_json(const StabilityAnalysis& analysis,
                                             const firmware::RigDescription& description);
[[nodiscard]] nlohmann::ordered_json to_json(const StabilityMap& map);
[[nodiscard]] nlohmann::ordered_json to_json(const PoleSweep& sweep);
[[nodiscard]] nlohmann::ordered_json to_json(const BodeData& data);
[[nodiscard]] nlohmann::ordered_json to_json(const NyquistData& data);

}  // namespace host_sim::stability
