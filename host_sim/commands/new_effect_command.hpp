// rigtwin new-effect: the files of a new effect in a source tree.
#pragma once

#include <filesystem>
#include <string>

namespace CLI {
class App;
}

namespace host_sim {

struct NewEffectOptions {
  std::string name;
  std::filesystem::path tree = ".";
  std::string json;
};

void add_new_effect(CLI::App& app, NewEffectOptions& options);

}  // namespace host_sim
