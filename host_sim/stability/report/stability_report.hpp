// The HTML page of `rigtwin stability --report`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/report/report.hpp"
#include "host_sim/stability/map/stability_map.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/over_amplitude.hpp"

namespace host_sim::stability {

/// The results of one analysis and of the sweeps and map that the user asked for.
struct StabilityFindings {
  const firmware::RigDescription& description;
  const StabilityAnalysis& analysis;
  const std::vector<PoleSweep>& sweeps;
  const std::optional<StabilityMap>& map;
  std::optional<OverAmplitude> over_amplitude{};
  std::string compensated{};  ///< verdict on the loop with its compensation; empty: it has none
  bool compensated_stable = false;
};

/// Verdict first, then roots, delay budget, Padé, sampled loop, sensitivities, loop and road responses, root loci, map,
/// amplitudes.
[[nodiscard]] report::Report stability_report(const StabilityFindings& findings);

}  // namespace host_sim::stability
