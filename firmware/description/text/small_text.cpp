#include "firmware/description/text/small_text.hpp"

#include <fstream>
#include <system_error>

#include "firmware/description/text/input_error.hpp"

namespace firmware {

std::string read_small_text(const std::filesystem::path& file, std::string_view expected) {
  const std::string name = file.string();
  std::string readable(expected);
  if (readable.starts_with("a ")) readable = "a readable " + readable.substr(2);
  std::error_code status;
  if (std::filesystem::is_directory(file, status)) throw InputError(name, 0, "is a directory", expected);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(name, 0, "cannot be opened", readable);
  constexpr std::size_t longest = 1U << 20U;
  std::string text(longest + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) throw InputError(name, 0, "cannot be read", readable);
  if (text.size() > longest) throw InputError(name, 0, "is larger than 1 MiB", expected);
  return text;
}

}  // namespace firmware
