// Where a disagreement sits.
#pragma once

#include <string>
#include <vector>

#include "host_sim/diagnose/noise_bands.hpp"
#include "host_sim/diagnose/search.hpp"

namespace host_sim::diagnose {

/// Where the power lies that refitted tolerances do not explain.
struct Place {
  model::Channel channel;
  double lowest, highest;  ///< band [Hz]
  std::string subsystem;
  double share;
};

/// Of what the refitted tolerances leave, the channels that count, the largest first. What is named in a channel or in
/// the rig is its place; else the `likely` one, if the redundancy tells of one.
[[nodiscard]] std::vector<Place> places(const std::vector<BandPower>& left, const Findings& findings,
                                        const std::string& likely);

}  // namespace host_sim::diagnose
