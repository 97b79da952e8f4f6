#include "host_sim/recording_files/text/text_encoding.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace host_sim {

void append_utf8(std::string& text, std::uint32_t code) {
  const auto byte = [&](std::uint32_t value) { text += static_cast<char>(static_cast<unsigned char>(value)); };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xc0U | code >> 6U);
    byte(0x80U | (code & 0x3fU));
  } else if (code < 0x10000) {
    byte(0xe0U | code >> 12U);
    byte(0x80U | (code >> 6U & 0x3fU));
    byte(0x80U | (code & 0x3fU));
  } else {
    byte(0xf0U | code >> 18U);
    byte(0x80U | (code >> 12U & 0x3fU));
    byte(0x80U | (code >> 6U & 0x3fU));
    byte(0x80U | (code & 0x3fU));
  }
}

namespace {

constexpr std::uint32_t replacement = 0xfffd;

std::string from_utf16(std::string_view bytes, bool big_endian) {
  const auto unit = [&](std::size_t i) {
    const auto a = static_cast<unsigned char>(bytes[i]);
    const auto b = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(big_endian ? a << 8U | b : b << 8U | a);
  };
  std::string text;
  text.reserve(bytes.size());
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const std::uint32_t first = unit(i);
    if (first < 0xd800 || first > 0xdfff) {
      append_utf8(text, first);
      continue;
    }
    const std::uint32_t second = first < 0xdc00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
    if (second >= 0xdc00 && second <= 0xdfff) {
      append_utf8(text, 0x10000U + ((first - 0xd800U) << 10U) + (second - 0xdc00U));
      i += 2;
    } else {
      append_utf8(text, replacement);
    }
  }
  return text;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    // Eight letters of ASCII at a time.
    std::uint64_t eight = 0;
    while (i + sizeof eight <= text.size()) {
      std::memcpy(&eight, text.data() + i, sizeof eight);
      if ((eight & 0x8080808080808080U) != 0) break;
      i += sizeof eight;
    }
    if (i == text.size()) break;
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80        ? 1
                               : first >> 5U == 6  ? 2
                               : first >> 4U == 14 ? 3
                               : first >> 3U == 30 ? 4
                                                   : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xc0U) != 0x80) return false;
    }
    i += length;
  }
  return true;
}

// Windows-1252: 0x80 … 0x9f; all others are their own code.
constexpr std::array<std::uint16_t, 32> windows_1252{0x20ac, 0xfffd, 0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021,
                                                     0x02c6, 0x2030, 0x0160, 0x2039, 0x0152, 0xfffd, 0x017d, 0xfffd,
                                                     0xfffd, 0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
                                                     0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0xfffd, 0x017e, 0x0178};

std::string from_windows_1252(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 16);
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    append_utf8(text, byte >= 0x80 && byte < 0xa0 ? windows_1252[byte - 0x80U] : byte);
  }
  return text;
}

enum class Encoding : unsigned char { eight_bit, utf16_little, utf16_big };

Encoding encoding_of(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe")) return Encoding::utf16_little;
  if (bytes.starts_with("\xfe\xff")) return Encoding::utf16_big;
  // Without a mark: Latin letters and digits have one zero byte each, always on the same side.
  const std::size_t length = std::min<std::size_t>(bytes.size(), 4096) / 2 * 2;
  std::array<std::size_t, 2> zeros{};
  for (std::size_t i = 0; i < length; ++i) zeros[i % 2] += bytes[i] == '\0' ? 1 : 0;
  if (length >= 8 && zeros[1] * 4 > length && zeros[0] * 50 < length) return Encoding::utf16_little;
  if (length >= 8 && zeros[0] * 4 > length && zeros[1] * 50 < length) return Encoding::utf16_big;
  return Encoding::eight_bit;
}

}  // namespace

std::string_view as_utf8(std::string_view bytes, std::string& converted) {
  if (encoding_of(bytes) == Encoding::eight_bit) {
    std::string_view text = bytes;
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    if (is_utf8(text)) return text;
  }
  converted = to_utf8(std::string(bytes));
  return converted;
}

std::string to_utf8(std::string bytes) {
  const Encoding encoding = encoding_of(bytes);
  if (encoding != Encoding::eight_bit) {
    std::string text = from_utf16(bytes, encoding == Encoding::utf16_big);
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    return text;
  }
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.erase(0, 3);
  return is_utf8(bytes) ? bytes : from_windows_1252(bytes);
}

bool looks_like_text(std::string_view bytes) {
  if (encoding_of(bytes) != Encoding::eight_bit) return true;
  bytes = bytes.substr(0, 4096);
  return std::none_of(bytes.begin(), bytes.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f' && byte != 0x1a;
  });
}

}  // namespace host_sim
