// Any bytes as the file of a road: an InputError of one line, or a motion of finite positions, no longer than asked
// for.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/simulation/profile_file.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size >= 4 && std::string_view(reinterpret_cast<const char*>(data), 4) == "MATL")
    return 0;  // has a fuzzer of its own
  static const int file = ::memfd_create("road", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  require(file >= 0 && ::ftruncate(file, 0) == 0);
  require(::pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  try {
    const firmware::FootPointMotion motion =
        firmware::road_from_file(path, 27.78, 1000.0, 2000, host_sim::read_recording);
    require(!motion.empty() && motion.size() <= 2000);
  } catch (const firmware::InputError& error) {
    const std::string_view line = error.what();
    require(line.starts_with(path) && line.find('\n') == std::string_view::npos);
  }
  return 0;
}
