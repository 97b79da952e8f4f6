// rigtwin init: a first rig description, with comments.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct InitOptions {
  std::filesystem::path out = "rig.toml";
  std::string kind;                   ///< empty: asked on a terminal
  std::optional<double> sample_rate;  ///< [Hz]
  std::optional<double> body, wheel;  ///< masses [kg]
  std::optional<double> tyre_stiffness, tyre_damping, suspension_stiffness, suspension_damping;  ///< [N/m], [N s/m]
  std::optional<double> virtual_damping;                                                         ///< hil [N s/m]
  bool fdva = false;
  std::string driven_by = "motion";  ///< or "force": a component_bench whose input is F, with a mass
  std::string json;
};

/// Adds the sub-command; `options` must live as long as `app`.
void add_init(CLI::App& app, InitOptions& options);

}  // namespace host_sim
