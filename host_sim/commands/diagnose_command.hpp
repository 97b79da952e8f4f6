// rigtwin diagnose: locates the disagreement between rig and model and names the missing effect.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/description/text/calendar_date.hpp"

namespace CLI {
class App;
}

namespace host_sim {

struct DiagnoseOptions {
  std::filesystem::path rig, out;
  std::vector<std::filesystem::path> data, holdout;
  std::string keep_law;                     ///< name under which a learned law stands in rig.toml; empty: law_1
  std::string json;                         ///< file for the verdict, - for standard output
  std::filesystem::path campaign, against;  ///< folder or list of recordings; results of an earlier campaign
  std::string recorded;                     ///< day of the recordings, "2026-03-01"; empty: today
  std::string shard;                        ///< "i/n" of a campaign
  std::string live;                         ///< HOST:PORT of a controller's datagrams, or a recording
  std::string socket;                       ///< of that controller
  std::string explain;                      ///< name of an effect; the other options are then unused
};
/// `recorded` as a day, else today. UsageError where it is no day.
[[nodiscard]] firmware::CalendarDate day_recorded(const DiagnoseOptions& options);

void run_diagnosis(const DiagnoseOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_diagnose(CLI::App& app, DiagnoseOptions& options);

}  // namespace host_sim
