// rigtwin effects: the catalogue as a list.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace host_sim {

struct EffectsOptions {
  std::string json;
};

/// Prints each effect of the catalogue with its equation, its place and its parameters.
void list_effects(const EffectsOptions& options);

void add_effects(CLI::App& app, EffectsOptions& options);

}  // namespace host_sim
