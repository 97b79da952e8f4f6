// rigtwin frf: frequency responses of recordings with 95 % bounds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace host_sim {

struct FrfOptions {
  std::vector<std::filesystem::path> data;
  std::string input;
  std::vector<std::string> outputs;
  std::optional<std::filesystem::path> rig;
  std::optional<std::filesystem::path> json;
  std::optional<std::filesystem::path> uff;
  std::optional<std::filesystem::path> report;
  std::string estimator;  ///< h1, h2, hv; empty: h1, or the instrumental estimate where there is an instrument
  std::optional<std::string> instrument;  ///< a channel or "none"
  std::string window = "hann";
  std::string detrend = "mean";
  std::optional<double> block;    ///< [s]
  std::optional<double> overlap;  ///< 0 … 0.95
  double lowest_damping = 0.2;
  double lowest_frequency = 1.2;  ///< [Hz]
  std::optional<double> from;     ///< lines below are left out [Hz]
  std::optional<double> to;       ///< lines above are left out [Hz]
  bool no_delay_compensation = false;
  bool unwrap = false;
};
void measure_responses(const FrfOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_frf(CLI::App& app, FrfOptions& options);

}  // namespace host_sim
