// rigtwin compare: recordings against the simulation of their own input, per channel and third-octave band.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host_sim/comparison/comparison.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct CompareOptions {
  std::filesystem::path rig;
  std::vector<std::filesystem::path> data;
  std::optional<std::filesystem::path> json;  ///< "-": standard output
  std::optional<std::filesystem::path> report;
  bool refit = false;  ///< first fit the parameters under [tolerance]
  StartChoice start = StartChoice::automatic;
};
void compare(const CompareOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_compare(CLI::App& app, CompareOptions& options);

}  // namespace host_sim
