// A part of a list that stays what it is when entries are added.
#pragma once

#include <cstdint>
#include <string_view>

namespace support {

/// True if the entry with this name belongs to `part`, 0 … parts − 1. The part follows from the name alone (FNV-1a).
[[nodiscard]] inline bool is_in_part(std::string_view name, std::uint64_t part, std::uint64_t parts) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return (hash >> 32U) % parts == part;
}

}  // namespace support
