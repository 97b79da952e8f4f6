#include "host_sim/commands/common/json_output.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"

namespace host_sim {

void add_json_option(CLI::App& command, std::string& target, const std::string& what) {
  command.add_option("--json", target, "Write " + what + " as JSON (- for standard output)");
}

bool write_json(const std::optional<std::filesystem::path>& target, const nlohmann::ordered_json& json) {
  if (!target) return false;
  const std::string text = json_text(json);
  if (*target == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return true;
  }
  firmware::write_file(*target, text);
  return false;
}

bool write_json(const std::string& target, const nlohmann::ordered_json& json) {
  return write_json(target.empty() ? std::nullopt : std::optional<std::filesystem::path>(target), json);
}

}  // namespace host_sim
