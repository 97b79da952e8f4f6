// Localisation: in which channels, bands and part of the rig the disagreement sits.
#pragma once

#include <string>
#include <vector>

#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// Where power lies that refitted tolerances do not explain (contract.md: "where").
struct RecordingLocation {
  model::Channel channel;
  double lowest, highest;  ///< band [Hz]
  std::string subsystem;
  double share;  ///< of all excess power, in units of noise
};

/// The channels with significant excess, the largest first. Their subsystem is that of the effect that was found in the
/// channel or in the rig, else the `likely` one of the parity relations, else the channel's own.
[[nodiscard]] std::vector<RecordingLocation> localise(const std::vector<BandPower>& left, const SearchResult& found,
                                                      const std::string& likely);

}  // namespace host_sim::identification
