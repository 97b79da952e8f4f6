#include "firmware/description/text/json_text.hpp"

#include <cstddef>

namespace firmware {
namespace {

/// Bytes of the UTF-8 character that begins with this one; 0: none does.
std::size_t utf8_length(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

/// True for two bytes that begin a character which is encoded too long, a surrogate, or beyond the last one.
bool is_forbidden(unsigned char first, unsigned char second) {
  return (first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) || (first == 0xf0 && second < 0x90) ||
         (first == 0xf4 && second >= 0x90);
}

bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(byte(i));
    if (length == 0 || i + length > text.size()) return false;
    if (length > 1 && is_forbidden(byte(i), byte(i + 1))) return false;
    for (std::size_t k = 1; k < length; ++k) {
      if ((byte(i + k) & 0xc0U) != 0x80U) return false;
    }
    i += length;
  }
  return true;
}

}  // namespace

std::string json_text(std::string_view text) {
  const bool readable = is_utf8(text);
  std::string json = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') json += '\\';
    if (byte < 0x20 || byte == 0x7f) {
      json += ' ';
    } else {
      json += byte >= 0x80 && !readable ? '?' : c;
    }
  }
  return json + "\"";
}

}  // namespace firmware
