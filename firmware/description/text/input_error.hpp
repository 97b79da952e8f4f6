// Errors in what a user passes to the programs: each is one complete line and an exit status.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

namespace firmware {

/// Exit status of rigtwin.
enum class ExitStatus : int { done = 0, wrong_usage = 2, unfit_input = 3, cannot_write = 4, internal = 5 };

/// The text in quotes on one line of a message: control characters are shown escaped, long text is cut.
[[nodiscard]] inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  constexpr std::string_view hex = "0123456789abcdef";
  std::string line = "'";
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      line += "\\x";
      line += hex[byte >> 4U];
      line += hex[byte & 0xfU];
    } else {
      line += c;
    }
  }
  line += text.size() > longest ? "…'" : "'";
  return line;
}

/// The text with its line ends and other control characters replaced by blanks: a file name may hold anything.
[[nodiscard]] inline std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return line;
}

/// The parts in a row, as one line.
[[nodiscard]] inline std::string one_line(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text += part;
  return one_line(text);
}

/// A wrong command line: what() is the line to print.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(std::string_view message) : std::runtime_error(one_line(message)) {}
};

/// A file that cannot be read or does not fit: what() is "file:line: what is wrong, expected what".
class InputError : public std::runtime_error {
 public:
  /// \param line counts from 1; 0 when the fault has no line.
  InputError(std::string_view file, std::size_t line, std::string_view wrong, std::string_view expected)
      : std::runtime_error(one_line({file, line > 0 ? ":" : "", line > 0 ? std::to_string(line) : std::string(), ": ",
                                     wrong, ", expected ", expected})) {}
};

/// A result that cannot be written: what() is "file: what is wrong, expected what".
class OutputError : public std::runtime_error {
 public:
  OutputError(std::string_view file, std::string_view wrong, std::string_view expected)
      : std::runtime_error(one_line({file, ": ", wrong, ", expected ", expected})) {}
};

}  // namespace firmware
