// rigtwin sweep: thousands of runs, on one machine or shared among the nodes of a cluster.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct SweepOptions {
  std::filesystem::path plan;
  std::filesystem::path out;
  std::string shard;             ///< "i/n"; empty: as a cluster's engine says, else all cases
  std::size_t jobs = 0;          ///< cases at once; 0: all processors, of a shard one
  std::filesystem::path merge;   ///< folder whose results become one table; excludes the others
  std::filesystem::path report;  ///< page of a merge
  std::string json;              ///< summary of a merge as JSON, "-": standard output
};
void sweep_command(const SweepOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_sweep(CLI::App& app, SweepOptions& options);

}  // namespace host_sim
