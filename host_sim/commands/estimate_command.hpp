// rigtwin estimate: the controller's Kalman filter over a recording.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace host_sim {

/// Options of `rigtwin estimate`.
struct EstimateOptions {
  std::string rig;
  std::string data;
  std::string out;
  std::string truth;   ///< noiseless recording of the same run; empty: none
  std::string report;  ///< HTML file; empty: none
  std::string json;    ///< empty: none
};

void estimate(const EstimateOptions& options);

/// Adds the command to the command line.
void add_estimate(CLI::App& app, EstimateOptions& options);

}  // namespace host_sim
