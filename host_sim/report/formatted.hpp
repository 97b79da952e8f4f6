// One line of text with numbers, as printf would write it.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace host_sim {

/// `format` with `values`, cut after 239 bytes: a line of a report or a message.
template <class... Values>
[[nodiscard]] std::string formatted(const char* format, Values... values) {
  std::array<char, 240> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

}  // namespace host_sim
