// Text with numbers, as printf writes it.
#pragma once

#include <array>
#include <cstdarg>
#include <cstdio>
#include <string>

namespace confusion {

/// At most 511 bytes.
__attribute__((format(printf, 1, 2))) inline std::string written(const char* format, ...) {
  std::array<char, 512> text{};
  std::va_list arguments;
  va_start(arguments, format);
  (void)std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  return text.data();
}

}  // namespace confusion
