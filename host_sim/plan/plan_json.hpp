// A plan as JSON; README.md has the keys.
#pragma once

#include <nlohmann/json.hpp>

#include "host_sim/plan/plan.hpp"

namespace host_sim::plan {

/// Every number is finite.
[[nodiscard]] nlohmann::ordered_json to_json(const Plan& plan);

}  // namespace host_sim::plan
