// The commands of the program rigtwin, as functions that a main calls.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/comparison.hpp"

namespace host_sim {

/// rigtwin simulate
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
};
void simulate(const SimulateOptions& options);

/// rigtwin compare
struct CompareOptions {
  std::filesystem::path rig;
  std::vector<std::filesystem::path> data;
  std::optional<std::filesystem::path> json;
  bool refit = false;
  StartChoice start = StartChoice::automatic;
};
void compare(const CompareOptions& options);

/// Runs the command line; returns the exit status of the contract. Every fault is one line on standard error.
[[nodiscard]] int run_command_line(int argc, const char* const* argv);

}  // namespace host_sim
