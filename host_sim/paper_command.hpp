// rigtwin paper: the paper's figures from the shipped rigs, and what its text says held against them.
#pragma once

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct PaperOptions {
  std::filesystem::path out;
};

/// Writes report.html and paper.json into the folder `out`, which is made if there is none; what else stands there
/// stays. An `out` that is no folder or may not be written is an OutputError.
void reproduce_paper(const PaperOptions& options);

/// Makes the sub-command known; `options` must live as long as `app`.
void add_paper(CLI::App& app, PaperOptions& options);

}  // namespace host_sim
