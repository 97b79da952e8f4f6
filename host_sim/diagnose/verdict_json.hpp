// verdict.json
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host_sim/diagnose/diagnosis.hpp"

namespace host_sim::diagnose {

/// The diagnosis as other people's scripts read it.
[[nodiscard]] nlohmann::ordered_json to_json(const Diagnosis& diagnosis);

}  // namespace host_sim::diagnose
