// rigtwin simulate: a simulated rig driven over a road through the firmware.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct SimulateOptions {
  std::filesystem::path rig;
  std::filesystem::path out;
  std::string road = "iso8608:B";   ///< iso8608:A … H, or a file with t [s] or s [m] and z_r [m]
  double speed = 27.78;             ///< [m/s]
  double duration = 60.0;           ///< [s]
  std::uint64_t seed = 1;           ///< of road and sensor noise
  std::optional<double> bandwidth;  ///< of an ISO 8608 road [Hz]
  std::optional<double> cut_off;    ///< of an ISO 8608 road [Hz]
  bool no_noise = false;
  bool allow_stop = false;  ///< a run that the firmware stopped is written and done
  std::string json;         ///< file, - for standard output
  std::filesystem::path report;
};
/// RunStopped where the firmware stops the run before its end, unless that is allowed; nothing is written then.
void simulate(const SimulateOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_simulate(CLI::App& app, SimulateOptions& options);

}  // namespace host_sim
