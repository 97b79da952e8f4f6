// --json, the same for every command.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace host_sim {

/// Adds `--json FILE` to a command; `what` is written: "the result". "-" is standard output.
void add_json_option(CLI::App& command, std::string& target, const std::string& what);

/// Writes `json`, an object, behind its head (how_made.hpp) to `target`, a file or "-" for standard output; nothing where there is none. True: standard output
/// holds the JSON, and nothing else may be printed there. OutputError if a file cannot be written.
[[nodiscard]] bool write_json(const std::optional<std::filesystem::path>& target, const nlohmann::ordered_json& json);
/// The same; an empty target is none.
[[nodiscard]] bool write_json(const std::string& target, const nlohmann::ordered_json& json);

}  // namespace host_sim
