// A comparison of recordings with their simulation, as a page.
#pragma once

#include <string>
#include <vector>

#include "host_sim/comparison/comparison.hpp"
#include "host_sim/show/recording_page.hpp"

namespace host_sim::show {

/// "The model of car.toml leaves 69 % of F_w, most of it at 12.5 Hz, and 2.1 % of zdd_b, the least." Of the pooled
/// comparisons of all recordings.
[[nodiscard]] std::string sentence(const std::vector<ChannelComparison>& pooled, const std::string& rig);

/// That sentence; measured and simulated over time; error by third-octave band in per cent of the channel; simulated
/// over measured, sample by sample; the table. `shown` and `comparisons` side by side, one model each.
[[nodiscard]] std::string comparison_page(const std::vector<Shown>& shown,
                                          const std::vector<RecordingComparison>& comparisons,
                                          const std::vector<ChannelComparison>& pooled, const std::string& rig);

}  // namespace host_sim::show
