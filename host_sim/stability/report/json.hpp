// Stability results as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "host_sim/stability/map/stability_map.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"
#include "host_sim/stability/margins/over_amplitude.hpp"

namespace host_sim::stability {

[[nodiscard]] nlohmann::ordered_json to_json(const StabilityAnalysis& analysis,
                                             const firmware::RigDescription& description);
[[nodiscard]] nlohmann::ordered_json to_json(const StabilityMap& map);
[[nodiscard]] nlohmann::ordered_json to_json(const PoleSweep& sweep);
[[nodiscard]] nlohmann::ordered_json to_json(const BodeData& data);
[[nodiscard]] nlohmann::ordered_json to_json(const NyquistData& data);
[[nodiscard]] nlohmann::ordered_json to_json(const OverAmplitude& over);

}  // namespace host_sim::stability
