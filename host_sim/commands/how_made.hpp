// How the page of a command was made: the command line and the files it names.
#pragma once

#include <string>

namespace host_sim {

/// Keeps the command line of this process for with_how_made(). Called once, before a command runs.
void remember_command_line(int argc, const char* const* argv);

/// Begins to read the input files beside the caller: SHA-256 of a recording of an hour takes seconds. with_how_made()
/// waits for it, or reads them itself.
void begin_how_made();

/// `page`, the text of a report, with version, command and the SHA-256 of each input file. Inputs are the files that
/// exist among the words of the command line, but those after --out, --json, --report and --uff, and the files that a
/// rig description among them names (tables of laws).
[[nodiscard]] std::string with_how_made(std::string page);

}  // namespace host_sim
