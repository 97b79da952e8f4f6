// A transfer as transfer.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host_sim/transfer/report/transfer_result.hpp"

namespace host_sim::transfer {

/// The keys are listed in the room's README. Every number is finite; what was not measured is null.
[[nodiscard]] nlohmann::json to_json(const Transfer& transfer);

}  // namespace host_sim::transfer
