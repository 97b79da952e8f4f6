// Any bytes as a sheet of an Excel workbook, with its strings and styles: a text.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "host_sim/recording_files/binary/workbook_file.hpp"

// The three parts stand one behind the other, between zero bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t first = all.find('\0');
  const std::size_t second = first == std::string_view::npos ? first : all.find('\0', first + 1);
  const auto part = [&](std::size_t from, std::size_t to) {
    return from >= all.size() ? std::string() : std::string(all.substr(from, to - from));
  };
  const std::string text =
      host_sim::text_of_sheet(part(0, first), first == std::string_view::npos ? std::string() : part(first + 1, second),
                              second == std::string_view::npos ? std::string() : part(second + 1, all.size()));
  if (text.empty() || text.back() != '\n') std::abort();
  return 0;
}
