// A plan as a page and as sentences.
#pragma once

#include <string>

#include "host_sim/plan/plan.hpp"

namespace host_sim::plan {

/// How many effects show, and what would help most.
[[nodiscard]] std::string summary(const Plan& plan);
/// One piece of advice.
[[nodiscard]] std::string sentence(const Advice& advice);
/// `road`: what the rig is driven over, in words.
[[nodiscard]] std::string report_html(const Plan& plan, const firmware::RigDescription& description,
                                      const std::string& road);

}  // namespace host_sim::plan
