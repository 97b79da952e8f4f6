// rigtwin paper: reproduces the paper's figures from the shipped rigs and checks the statements of its text.
#pragma once

#include <filesystem>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct PaperOptions {
  std::filesystem::path out;
  std::string json;  ///< paper.json here, too; "-": standard output
};

/// Writes report.html and paper.json into the folder `out`, which is created if it does not exist; other files in it
/// are left alone. OutputError if `out` is not a folder or cannot be written.
void reproduce_paper(const PaperOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_paper(CLI::App& app, PaperOptions& options);

}  // namespace host_sim
