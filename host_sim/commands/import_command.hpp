// rigtwin import: a measurement file of another program as a recording.
#pragma once

#include <filesystem>
#include <optional>

#include "host_sim/recording_files/import.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct ImportOptions {
  std::filesystem::path file;
  std::optional<std::filesystem::path> out;  ///< nullopt: the columns are listed
  std::optional<std::filesystem::path> rig;
  bool write_channels = false;                ///< put the mapping into the rig description
  std::optional<std::filesystem::path> json;  ///< "-": standard output
  ImportChoices choices;
};
void import_recording(const ImportOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_import(CLI::App& app, ImportOptions& options);

}  // namespace host_sim
