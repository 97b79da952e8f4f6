#include "host_sim/recording.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "host_sim/output_file.hpp"
#include "host_sim/recording_columns.hpp"

namespace host_sim {
namespace {

constexpr std::string_view a_recording = "a recording, CSV or MATLAB 5 or 7.3";

bool is_called_mat(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".mat";
}

// A MATLAB 5 file has 116 bytes of text, then, at 124, its version and byte order; 7.3 is HDF5 behind such a header.
bool is_matlab(std::string_view head) {
  if (head.size() < 128) return false;
  const std::string_view version = head.substr(124, 4);
  return version == std::string_view("\x00\x01IM", 4) || version == std::string_view("\x01\x00MI", 4) ||
         version == std::string_view("\x00\x02IM", 4) || version == std::string_view("\x02\x00MI", 4);
}

class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& file) : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

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

// What a caller hands to be written must be whole: columns of one length, as a reader will expect them.
void check_columns(const std::filesystem::path& file, const Recording& recording) {
  const auto check = [&](std::string_view column, std::size_t size) {
    if (size == recording.size()) return;
    throw std::logic_error(file.string() + ": column " + std::string(column) + " has " + std::to_string(size) +
                           " samples, t has " + std::to_string(recording.size()));
  };
  for (Quantity q = 0; q < quantity_count; ++q) {
    if (!values(recording, q).empty()) check(name(q), values(recording, q).size());
  }
  for (const ExtraColumn& extra : recording.extra) check(extra.name, extra.values.size());
}

}  // namespace

const std::vector<double>& Recording::required(model::Channel channel, std::string_view purpose) const {
  if (!has(channel)) {
    throw InputError(source, 0, "there is no channel " + std::string(model::name(channel)),
                     "that channel: it " + std::string(purpose));
  }
  return (*this)[channel];
}

Recording read_recording(const std::filesystem::path& file, const ChannelMap& map,
                         std::optional<double> expected_rate) {
  const std::string source = file.string();
  const Descriptor opened(file);
  if (opened.get() < 0) {
    throw InputError(source, 0, std::string("cannot be opened: ") + std::strerror(errno), a_recording);
  }
  struct stat status {};
  if (::fstat(opened.get(), &status) == 0 && S_ISDIR(status.st_mode)) {
    throw InputError(source, 0, "is a directory", a_recording);
  }
  std::string head = read_head(opened.get(), source);
  if (is_matlab(head)) return read_recording_mat(file, map, expected_rate);
  if (is_called_mat(file) && !head.empty()) {
    throw InputError(source, 0, "is not a MATLAB 5 or 7.3 file", "one saved with -v6, -v7 or -v7.3");
  }
  return read_recording_csv(opened.get(), std::move(head), source, map, expected_rate);
}

void write_recording(const std::filesystem::path& file, const Recording& recording) {
  check_columns(file, recording);
  if (is_called_mat(file)) return write_recording_mat(file, recording);
  OutputFile output(file);
  format_recording_csv(recording, [&](std::string_view text) { output.write(text); });
  output.commit();
}

}  // namespace host_sim
