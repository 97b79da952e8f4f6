// Where the commands of the manual are run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace host_sim::manual {

/// A folder in which blocks of commands are run one after the other, as a user would type them into one shell: files
/// stay, variables do not. It is removed at the end.
class Workshop {
 public:
  struct Setting {
    std::filesystem::path programs;  ///< folder of rigtwin and rig_controller, first on the path
    /// Further variables of the commands: NAME=value.
    std::vector<std::string> variables{};
  };
  struct Ended {
    int status = 0;        ///< exit status; 128 + n: by signal n
    std::string output{};  ///< standard output and standard error as they came
  };

  explicit Workshop(const Setting& setting);
  ~Workshop();
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

  /// Runs `commands` by /bin/sh -e.
  [[nodiscard]] Ended run(const std::string& commands);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  Setting setting_;
  std::filesystem::path folder_;
};

}  // namespace host_sim::manual
