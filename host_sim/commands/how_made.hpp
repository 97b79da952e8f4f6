// How the page of a command was made: the command line and the files it names.
#pragma once

#include <future>
#include <string>

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

  /// `page`, the text of a report, with them; once.
  [[nodiscard]] std::string in(std::string page);

 private:
  std::future<report::Origin> origin_;
};

/// The same, read when it is called.
[[nodiscard]] std::string with_how_made(std::string page);

}  // namespace host_sim
