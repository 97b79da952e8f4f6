// Any bytes as a MATLAB or HDF5 file: an InputError of one line or a recording. The libraries read the file in a child
// process (host_sim/recording_files/binary/isolated_reader.hpp), so the tested property is that nothing they do there
// gets out.
#include <pthread.h>
#include <sanitizer/common_interface_defs.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

// The child's limit of memory is off under the address sanitizer; this one takes its place.
extern "C" const char* __asan_default_options() { return "max_allocation_size_mb=256:allocator_may_return_null=1"; }

// What ends the child is expected: it is not to be kept as a finding.
extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  return ::pthread_atfork(nullptr, nullptr, [] { __sanitizer_set_death_callback(nullptr); });
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("recording", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  require(file >= 0 && ::ftruncate(file, 0) == 0);
  require(::pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  try {
    const firmware::Recording recording = host_sim::read_recording(path);
    require(recording.size() >= 2 && recording.sample_period > 0.0);
    for (const auto& channel : recording.channels) require(channel.empty() || channel.size() == recording.size());
  } catch (const firmware::InputError& error) {
    const std::string_view line = error.what();
    require(line.starts_with(path) && line.find('\n') == std::string_view::npos);
  }
  return 0;
}
