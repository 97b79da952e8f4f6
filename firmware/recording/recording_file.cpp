#include "firmware/recording/recording_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "firmware/description/text/input_error.hpp"

namespace firmware {
namespace {

constexpr std::string_view a_recording = "a recording, CSV or MATLAB 5 or 7.3";

std::string read_head(int descriptor, std::string_view source) {
  std::string head(1024, '\0');
  std::size_t size = 0;
  while (size < head.size()) {
    const ssize_t got = ::read(descriptor, head.data() + size, head.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(source, 0, std::string("cannot be read: ") + std::strerror(errno), a_recording);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  head.resize(size);
  return head;
}

}  // namespace

RecordingFile::RecordingFile(const std::filesystem::path& file)
    : descriptor_(file == "-" ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                              : ::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  const std::string source = file.string();
  if (descriptor_ < 0) {
    throw InputError(source, 0, std::string("cannot be opened: ") + std::strerror(errno), a_recording);
  }
  struct stat status {};
  try {
    if (::fstat(descriptor_, &status) == 0 && S_ISDIR(status.st_mode)) {
      throw InputError(source, 0, "is a directory", a_recording);
    }
    head_ = read_head(descriptor_, source);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

RecordingFile::~RecordingFile() { ::close(descriptor_); }

// A MATLAB 5 file has 116 bytes of text, then, at 124, its version and byte order; 7.3 is HDF5 behind such a header.
bool RecordingFile::is_matlab() const {
  if (head_.size() < 128) return false;
  const std::string_view version = std::string_view(head_).substr(124, 4);
  return version == std::string_view("\x00\x01IM", 4) || version == std::string_view("\x01\x00MI", 4) ||
         version == std::string_view("\x00\x02IM", 4) || version == std::string_view("\x02\x00MI", 4);
}

}  // namespace firmware
