// Stability of a compensated loop as JSON and as a section of a page.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "host_sim/compensation/compensated_stability.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::compensation {

/// kind, stable, spectral_radius, roots, margins, mismatch; `map` where it is there.
[[nodiscard]] nlohmann::ordered_json to_json(const CompensatedStability& stability,
                                             const std::optional<MismatchMap>& map);

void add_stability_section(report::Report& page, const CompensatedStability& stability, const MismatchMap& map);

}  // namespace host_sim::compensation
