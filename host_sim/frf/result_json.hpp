// Frequency responses as JSON.
#pragma once

#include <string>

#include "host_sim/frf/response_estimate.hpp"

namespace host_sim::frf {

/// The contract's object – "input", "averages", "outputs" – with what was chosen beside it. The bounds are pairs
/// [low, high] by frequency; null stands for a number that is not finite: no input power, no upper bound.
[[nodiscard]] std::string to_json(const Responses& responses);

}  // namespace host_sim::frf
