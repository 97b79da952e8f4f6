#include "host_sim/recording_files/text/text_fields.hpp"

#include <cstring>

#include "firmware/recording/column_targets.hpp"

namespace host_sim {

const std::vector<std::string_view>& FieldSplitter::split(std::string_view line, char column) {
  fields_.clear();
  unquoted_.clear();
  const bool blanks = column == ' ';
  if (blanks) line = firmware::trimmed(line);
  std::size_t i = 0;
  for (;;) {
    while (i < line.size() && (line[i] == ' ' || (line[i] == '\t' && column != '\t'))) ++i;
    if (i < line.size() && line[i] == '"') {
      fields_.push_back(quoted_field(line, i, column));
    } else {
      const std::size_t begin = i;
      if (blanks) {
        while (i < line.size() && line[i] != ' ' && line[i] != '\t') ++i;
      } else {
        const void* found = i < line.size() ? std::memchr(line.data() + i, column, line.size() - i) : nullptr;
        i = found == nullptr ? line.size() : static_cast<std::size_t>(static_cast<const char*>(found) - line.data());
      }
      std::size_t end = i;
      while (end > begin && (line[end - 1] == ' ' || line[end - 1] == '\t')) --end;
      fields_.push_back(line.substr(begin, end - begin));
    }
    if (i >= line.size()) return fields_;
    ++i;
  }
}

std::string_view FieldSplitter::quoted_field(std::string_view line, std::size_t& i, char column) {
  const auto is_end = [&](char c) { return column == ' ' ? c == ' ' || c == '\t' : c == column; };
  const std::size_t begin = i++;
  bool doubled = false;
  bool closed = false;
  for (; i < line.size(); ++i) {
    if (line[i] != '"') continue;
    if (i + 1 >= line.size() || line[i + 1] != '"') {
      closed = true;
      break;
    }
    doubled = true;
    ++i;
  }
  const std::size_t close = i;
  if (closed) ++i;
  bool quoted = false;  // a separator inside further quotes does not end the field
  while (i < line.size() && (quoted || !is_end(line[i]))) {
    if (line[i] == '"') quoted = !quoted;
    ++i;
  }
  if (closed && !firmware::trimmed(line.substr(close + 1, i - close - 1)).empty())
    return firmware::trimmed(line.substr(begin, i - begin));
  const std::string_view inside = line.substr(begin + 1, close - begin - 1);
  if (!doubled) return inside;
  std::string& text = unquoted_.emplace_back();
  for (std::size_t k = 0; k < inside.size(); ++k) {
    text += inside[k];
    if (inside[k] == '"') ++k;
  }
  return text;
}

}  // namespace host_sim
