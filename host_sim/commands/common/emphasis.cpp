#include "host_sim/commands/common/emphasis.hpp"

#include <unistd.h>

#include <cstdlib>

namespace host_sim {

std::string emphasised(std::string_view text, Emphasis emphasis, bool terminal, const char* no_color,
                       const char* term) {
  const bool asked_not_to = no_color != nullptr && *no_color != '\0';
  const bool able = term != nullptr && std::string_view(term) != "dumb";
  if (!terminal || asked_not_to || !able) return std::string(text);
  return (emphasis == Emphasis::error ? "\033[1;31m" : "\033[1m") + std::string(text) + "\033[0m";
}

std::string emphasised(std::string_view text, Emphasis emphasis, std::FILE* stream) {
  return emphasised(text, emphasis, isatty(fileno(stream)) == 1, std::getenv("NO_COLOR"), std::getenv("TERM"));
}

}  // namespace host_sim
