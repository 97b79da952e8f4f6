#include "firmware/description/model_watch.hpp"

#include <cstddef>
#include <string_view>

namespace firmware {

bool model_watch_stops(const RigDescription& description) {
  const auto key = description.lines.find("controller.model_watch");
  if (key == description.lines.end()) return false;
  std::string_view text = description.text;
  for (std::size_t line = 1; line < key->second; ++line) text.remove_prefix(text.find('\n') + 1);
  text = text.substr(0, text.find('\n'));
  // The reader has let in two words, in either kind of quotes; a comment may follow.
  const std::size_t name = text.find("model_watch"), quote = text.find_first_of("\"'", name);
  return quote != std::string_view::npos && text.substr(quote + 1).starts_with("stop");
}

}  // namespace firmware
