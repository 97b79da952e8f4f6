// rigtwin transfer: what was learned on one rig predicts another.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct TransferOptions {
  std::filesystem::path from, to;
  std::vector<std::filesystem::path> data, measured;
  std::string road = "iso8608:B";  ///< iso8608:A … H, or a file with t [s] or s [m], and z_r [m]
  double speed = 27.78;            ///< [m/s]
  double duration = 60.0;          ///< [s]
  std::uint64_t seed = 1;          ///< of road and draws
  std::size_t draws = 10000;
  std::filesystem::path out;
  std::string json;  ///< transfer.json here, too; "-": standard output
};
void run_transfer(const TransferOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_transfer(CLI::App& app, TransferOptions& options);

}  // namespace host_sim
