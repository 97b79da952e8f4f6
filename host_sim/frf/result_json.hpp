// Frequency responses as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host_sim/frf/response_estimate.hpp"

namespace host_sim::frf {

/// The keys "input", "averages", "outputs" of the contract, and the chosen settings. Bounds are pairs [low, high] by
/// frequency; null is a number that is not finite: no input power, no upper bound.
[[nodiscard]] nlohmann::ordered_json to_json(const Responses& responses);

}  // namespace host_sim::frf
