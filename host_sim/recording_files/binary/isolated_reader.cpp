#include "host_sim/recording_files/binary/isolated_reader.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "firmware/description/text/input_error.hpp"

namespace host_sim {
namespace {

constexpr rlim_t most_memory = rlim_t{4} << 30U;     // [byte]
constexpr rlim_t least_memory = rlim_t{256} << 20U;  // [byte] of the libraries themselves
constexpr rlim_t most_processor_time = 120;          // [s]
constexpr std::uint8_t finished = 0xff;              // in place of a LeafKind

// [byte] The most memory that reading the file `source` can need. Deflate compresses at most 1032 bytes into one byte.
// Each of these bytes can become a double, which the library and the leaf hold once each.
rlim_t memory_to_read(const std::string& source) {
  std::error_code unknown;  // the size is then the largest number
  const rlim_t size = std::min<rlim_t>(std::filesystem::file_size(source, unknown), most_memory);
  return std::min(most_memory, least_memory + size * 1032 * 2 * sizeof(double));
}

// [byte] Private memory that can be written, as RLIMIT_DATA counts it: the sixth number of the kernel's line. Where the
// kernel does not say it, the limit must not be lower than what is in use already.
rlim_t memory_in_use() {
  std::ifstream line("/proc/self/statm");
  rlim_t pages = 0;
  for (int i = 0; i < 6; ++i) line >> pages;
  return line ? pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) : most_memory;
}

[[noreturn]] void be_child(int descriptor, rlim_t memory, const std::function<void(const LeafSender&)>& read) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) {
    std::signal(signal, SIG_DFL);  // dies of it, and leaves the parent's files alone
  }
  const rlimit no_core{0, 0};
  const rlimit time{most_processor_time, most_processor_time};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
  const rlim_t most = memory_in_use() + memory;
  const rlimit data{most, most};
  ::setrlimit(RLIMIT_DATA, &data);
  // A large block in a file (mapped_memory.hpp) is bounded as one on the heap is.
  const rlimit block{memory, memory};
  std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &block);
  static_cast<void>(std::freopen("/dev/null", "w", stderr));  // what HDF5 has to say about a damaged file
  try {
    read(LeafSender(descriptor));
    ::_exit(0);
  } catch (...) {
    ::_exit(1);
  }
}

class LeafReceiver {
 public:
  LeafReceiver(int descriptor, std::uint64_t most) : descriptor_(descriptor), most_(most) {}

  struct Message {
    std::optional<Leaf> leaf;  // none: finished
    std::size_t count = 0;
  };

  // The next message; none when the child has ended too early. A child whose memory is damaged may send anything.
  [[nodiscard]] std::optional<Message> receive() const {
    std::uint8_t kind = 0;
    std::array<std::uint64_t, 4> sizes{};  // path, shape, numbers, text
    if (!receive_bytes(&kind, sizeof kind) || !receive_bytes(sizes.data(), sizeof sizes)) return std::nullopt;
    if (kind == finished) return Message{std::nullopt, sizes[0]};
    if (kind > static_cast<std::uint8_t>(LeafKind::last) || sizes[0] > most_ || sizes[1] > 64 ||
        sizes[2] > most_ / sizeof(double) || sizes[3] > most_) {
      return std::nullopt;
    }
    Leaf leaf;
    leaf.kind = static_cast<LeafKind>(kind);
    leaf.path.resize(sizes[0]);
    leaf.shape.resize(sizes[1]);
    leaf.numbers.resize(sizes[2]);
    leaf.text.resize(sizes[3]);
    const bool whole = receive_bytes(leaf.path.data(), leaf.path.size()) &&
                       receive_bytes(leaf.shape.data(), leaf.shape.size() * sizeof(std::size_t)) &&
                       receive_bytes(leaf.numbers.data(), leaf.numbers.size() * sizeof(double)) &&
                       receive_bytes(leaf.text.data(), leaf.text.size());
    if (!whole) return std::nullopt;
    return Message{std::move(leaf)};
  }

 private:
  bool receive_bytes(void* bytes, std::size_t size) const {
    for (char* p = static_cast<char*>(bytes); size > 0;) {
      const ssize_t got = ::read(descriptor_, p, size);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      p += got;
      size -= static_cast<std::size_t>(got);
    }
    return true;
  }

  int descriptor_;
  std::uint64_t most_;  // [byte] of one part of a message
};

// The child process, ended at the latest when this object is.
class ReaderProcess {
 public:
  ReaderProcess(const std::string& source, rlim_t memory, const std::function<void(const LeafSender&)>& read) {
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) != 0) throw_cannot_start(source);
    process_ = ::fork();
    if (process_ == 0) {
      ::close(pipe[0]);
      be_child(pipe[1], memory, read);
    }
    ::close(pipe[1]);
    descriptor_ = pipe[0];
    if (process_ < 0) {
      ::close(descriptor_);
      throw_cannot_start(source);
    }
  }
  ~ReaderProcess() {
    ::close(descriptor_);
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  [[noreturn]] static void throw_cannot_start(std::string_view source) {
    throw firmware::InputError(source, 0, std::string("cannot start a process to read it: ") + std::strerror(errno),
                               "a free process");
  }

  pid_t process_ = -1;
  int descriptor_ = -1;
};

}  // namespace

bool Leaf::is_vector() const {
  return kind == LeafKind::numbers && !numbers.empty() &&
         std::count_if(shape.begin(), shape.end(), [](std::size_t length) { return length != 1; }) <= 1;
}

void LeafSender::send(const Leaf& leaf) const {
  const std::array<std::uint64_t, 4> sizes{leaf.path.size(), leaf.shape.size(), leaf.numbers.size(), leaf.text.size()};
  send_bytes(&leaf.kind, sizeof leaf.kind);
  send_bytes(sizes.data(), sizeof sizes);
  send_bytes(leaf.path.data(), leaf.path.size());
  send_bytes(leaf.shape.data(), leaf.shape.size() * sizeof(std::size_t));
  send_bytes(leaf.numbers.data(), leaf.numbers.size() * sizeof(double));
  send_bytes(leaf.text.data(), leaf.text.size());
}

void LeafSender::finish(std::size_t count) const {
  const std::array<std::uint64_t, 4> sizes{count, 0, 0, 0};
  send_bytes(&finished, sizeof finished);
  send_bytes(sizes.data(), sizeof sizes);
}

void LeafSender::send_bytes(const void* bytes, std::size_t size) const {
  for (const char* p = static_cast<const char*>(bytes); size > 0;) {
    const ssize_t sent = ::write(descriptor_, p, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) ::_exit(1);
    p += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

IsolatedResult read_isolated(const std::string& source, std::string_view expected,
                             const std::function<void(const LeafSender&)>& read) {
  const rlim_t memory = memory_to_read(source);
  const ReaderProcess child(source, memory, read);
  const LeafReceiver receiver(child.descriptor(), memory);
  IsolatedResult result{{}, 0};
  for (;;) {
    std::optional<LeafReceiver::Message> message = receiver.receive();
    if (!message) {
      throw firmware::InputError(
          source, 0,
          "the file is damaged" + (result.leaves.empty() ? "" : " after variable " + result.leaves.back().path),
          expected);
    }
    if (!message->leaf) {
      result.count = message->count;
      return result;
    }
    if (message->leaf->kind == LeafKind::damaged) {
      throw firmware::InputError(
          source, 0, "the file is damaged" + (message->leaf->path.empty() ? "" : " in variable " + message->leaf->path),
          expected);
    }
    result.leaves.push_back(std::move(*message->leaf));
  }
}

}  // namespace host_sim
