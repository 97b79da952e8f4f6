// rigtwin diagnose: where rig and model disagree, and which effect is missing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace host_sim {

struct DiagnoseOptions {
  std::filesystem::path rig, out;
  std::vector<std::filesystem::path> data, holdout;
  std::string explain;  ///< instead of all others
};
void run_diagnosis(const DiagnoseOptions& options);

/// Makes the sub-command known; `options` must live as long as `app`.
void add_diagnose(CLI::App& app, DiagnoseOptions& options);

}  // namespace host_sim
