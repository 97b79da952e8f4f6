// The page that `rigtwin stability --report` writes.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/report/report.hpp"
#include "host_sim/rig_description.hpp"
#include "host_sim/stability/analysis.hpp"
#include "host_sim/stability/stability_map.hpp"

namespace host_sim::stability {

/// What was found out about a rig, and what was asked for beside it.
struct StabilityFindings {
  const RigDescription& description;
  const StabilityAnalysis& analysis;
  const std::vector<PoleSweep>& sweeps;
  const std::optional<StabilityMap>& map;
};

/// Verdict first; roots, delay budget, Padé, sampled loop, sensitivities, loop and road responses, root loci, map.
[[nodiscard]] report::Report stability_report(const StabilityFindings& findings);

}  // namespace host_sim::stability
