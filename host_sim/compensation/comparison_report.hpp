// A comparison of compensators as JSON and as a page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "host_sim/compensation/method_comparison.hpp"

namespace host_sim::compensation {

[[nodiscard]] nlohmann::ordered_json to_json(const MethodComparison& comparison);

/// One HTML file.
[[nodiscard]] std::string comparison_page(const MethodComparison& comparison,
                                          const firmware::RigDescription& description);

}  // namespace host_sim::compensation
