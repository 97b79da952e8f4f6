// rigtwin show: recordings as a page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace host_sim {

struct ShowOptions {
  std::vector<std::filesystem::path> data;
  std::vector<std::string> rigs;
  std::filesystem::path report;
  std::string json;
};

/// Writes the page, and prints its first sentence. With rigs the model of each lies behind every recording.
void show_recordings(const ShowOptions& options);

/// Adds the sub-command; `options` must live as long as `app`.
void add_show(CLI::App& app, ShowOptions& options);

}  // namespace host_sim
