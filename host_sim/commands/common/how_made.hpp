// The origin of a page or a JSON result: the command line and the files it names.
#pragma once

#include <future>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_sim/report/report.hpp"

namespace host_sim {

/// Keeps the command line of this process for with_how_made(). Called once, before a command runs.
void remember_command_line(int argc, const char* const* argv);

/// Version, command and the SHA-256 of each input file. Inputs are the files that exist among the words of the command
/// line, but those after --out, --json, --report and --uff, and the files that a rig description among them names
/// (tables of laws). They are read beside the caller, from the construction on: a recording of an hour takes seconds.
class HowMade {
 public:
  HowMade();

  /// `page`, the text of a report, with them.
  [[nodiscard]] std::string in(std::string page) const;

  /// The JSON text of `result`, an object, behind its head: {"schema": "rigtwin/COMMAND/1", "version": "…",
  /// "command": "…", "inputs": [{"name": "…", "sha256": "…"}], …}. The number in "schema" rises when a key is renamed
  /// or gets another meaning (host_sim/schemas). Text that is no UTF-8 becomes U+FFFD.
  [[nodiscard]] std::string json(const nlohmann::ordered_json& result) const;

 private:
  std::shared_future<report::Origin> origin_;
};

/// Command and these files, with the tables that a description among them names. A file that cannot be read is not there.
[[nodiscard]] report::Origin origin_of(std::string command, const std::vector<std::string>& files);

/// The JSON text of a result of that origin behind its head, as HowMade::json() writes it.
[[nodiscard]] std::string json_text(const report::Origin& origin, const std::string& schema,
                                    const nlohmann::ordered_json& result);

/// The same, read when it is called.
[[nodiscard]] std::string with_how_made(std::string page);
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& result);

}  // namespace host_sim
