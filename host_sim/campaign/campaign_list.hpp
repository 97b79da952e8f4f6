// The recordings of a campaign and their rigs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace host_sim::campaign {

/// One recording of a campaign.
struct CampaignRecord {
  std::string name;                 ///< unique in the campaign; of its folder in the results, too
  std::filesystem::path data, rig;  ///< recording, description
};

/// The recordings of a folder (every file whose ending is a recording's, by name, with the numbers in it in their
/// order: run_9 before run_10), all of `rig`; or those of a list:
///
///     rig = "car.toml"                      # of all that name none; --rig goes before it
///     [[record]]
///     data = "monday/run_1.csv"             # relative to the list
///     rig  = "car_2.toml"
///     name = "car 2, monday 1"              # default: the file's name
///
/// InputError: no recording, no rig, a file that is not there, two records of one name.
[[nodiscard]] std::vector<CampaignRecord> campaign_records(const std::filesystem::path& campaign,
                                                           const std::optional<std::filesystem::path>& rig);

}  // namespace host_sim::campaign
