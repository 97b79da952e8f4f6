// rigtwin plan: what an experiment would show, before it is made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct PlanOptions {
  std::filesystem::path rig;
  std::string road = "iso8608:B";    ///< iso8608:A … H, or a file with t [s] or s [m] and z_r [m]
  double speed = 27.78;              ///< [m/s]
  double duration = 60.0;            ///< [s]
  double level = 1.0;                ///< factor of the road
  std::uint64_t seed = 1;            ///< of road and sensor noise
  std::vector<std::string> without;  ///< channels that are not recorded
  std::string json;                  ///< file, - for standard output
  std::filesystem::path report;
};
void run_plan(const PlanOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_plan(CLI::App& app, PlanOptions& options);

}  // namespace host_sim
