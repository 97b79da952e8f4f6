// Bold and red text on a terminal.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace host_sim {

enum class Emphasis { bold, error };

/// The text, bold or (an error) bold and red where `stream` is a terminal that shows colours. Plain elsewhere, where NO_COLOR is set to
/// anything (no-color.org), and where TERM is "dumb" or missing.
[[nodiscard]] std::string emphasised(std::string_view text, Emphasis emphasis, std::FILE* stream);

/// The same for a stream that is a terminal or not, with these values of the environment (nullptr: not set).
[[nodiscard]] std::string emphasised(std::string_view text, Emphasis emphasis, bool terminal, const char* no_color,
                                     const char* term);

}  // namespace host_sim
