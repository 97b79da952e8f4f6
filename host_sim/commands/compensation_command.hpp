// rigtwin compensation: compensators of a hil rig's delay, compared.
#pragma once

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace host_sim {

struct CompensationOptions {
  std::string rig;
  std::optional<std::string> json, report;
  std::optional<std::string> data;  ///< a recording of the machine
  std::optional<std::string> out;   ///< the command that would have made it follow
};

void add_compensation(CLI::App& app, CompensationOptions& options);

}  // namespace host_sim
