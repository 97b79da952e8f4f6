// rigtwin stability: poles, critical delay, critical virtual damping, margins.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct StabilityOptions {
  std::filesystem::path rig;
  std::optional<std::filesystem::path> write_limits;  ///< the description to write the proof into
  std::optional<std::filesystem::path> json;
  std::optional<std::filesystem::path> report;
  std::vector<std::string> sweeps;  ///< "variable=from:to:count"
  std::optional<std::string> map;   ///< two of these, "x,y"
  std::optional<double> amplitude;  ///< the largest of the deflection at which the loop is analysed [m]
  bool responses = false;           ///< adds Bode and Nyquist data to the JSON
  double line = -60.0;              ///< roots with a real part above it are listed [1/s]
};
void examine_stability(const StabilityOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_stability(CLI::App& app, StabilityOptions& options);

}  // namespace host_sim
