// rigtwin replicate
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace host_sim {

struct ReplicateOptions {
  std::filesystem::path folder;  ///< of a replication that was begun
  std::filesystem::path rig;
  std::vector<std::filesystem::path> target;
  std::string channels;
  std::vector<std::string> bands;
  std::filesystem::path data;  ///< an earlier run
  std::filesystem::path out;
  std::filesystem::path measured;
  bool diagnose = false;
  std::filesystem::path simulated;
  int runs = 4;
  std::uint64_t seed = 1;
  double goal = 0.01;
  std::vector<std::filesystem::path> more;  ///< further files for the newest drive
  std::string json;
};

void add_replicate(CLI::App& app, ReplicateOptions& options);

}  // namespace host_sim
