#include "firmware/recording/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <system_error>

#include "firmware/description/text/input_error.hpp"

namespace firmware {
namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 18U;

// The temporary files that exist now, for a signal handler: no heap, no lock. `owner` is the process that made the file
// (0: slot free, −1: being filled), so that a forked child does not remove its parent's.
struct UnfinishedFile {
  std::atomic<pid_t> owner{0};
  std::array<char, PATH_MAX> path{};
};
constexpr std::size_t most_unfinished_files = 32;
std::array<UnfinishedFile, most_unfinished_files> unfinished_files;
static_assert(std::atomic<pid_t>::is_always_lock_free, "a signal handler reads it");

constexpr std::initializer_list<int> ending_signals{SIGINT, SIGTERM, SIGHUP};

extern "C" void remove_unfinished_files_and_end(int signal) {
  remove_unfinished_files();
  // The handler was installed for one shot: raised again, the signal ends the program the way its parent expects.
  static_cast<void>(std::raise(signal));
}

void install_handlers() {
  for (const int signal : ending_signals) {
    struct sigaction present {};
    if (::sigaction(signal, nullptr, &present) != 0 || present.sa_handler != SIG_DFL) continue;
    struct sigaction ours {};
    ours.sa_handler = remove_unfinished_files_and_end;
    ours.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigemptyset(&ours.sa_mask);
    ::sigaction(signal, &ours, nullptr);
  }
}

std::size_t remember(const std::string& path) {
  if (path.size() >= PATH_MAX) throw OutputError(path, "the name is too long", "a shorter one");
  for (std::size_t i = 0; i < most_unfinished_files; ++i) {
    pid_t none = 0;
    if (!unfinished_files[i].owner.compare_exchange_strong(none, -1)) continue;
    std::memcpy(unfinished_files[i].path.data(), path.c_str(), path.size() + 1);
    unfinished_files[i].owner = ::getpid();
    return i;
  }
  throw OutputError(path, "too many files are being written at once",
                    "at most " + std::to_string(most_unfinished_files));
}

void forget(std::size_t slot) noexcept { unfinished_files[slot].owner = 0; }

std::string reason() { return std::strerror(errno); }

}  // namespace

void remove_unfinished_files() noexcept {
  const int error = errno;
  for (const UnfinishedFile& file : unfinished_files) {
    if (file.owner == ::getpid()) ::unlink(file.path.data());
  }
  errno = error;
}

OutputFile::OutputFile(const std::filesystem::path& file) : name_(file.string()) {
  namespace fs = std::filesystem;
  static const bool installed = (install_handlers(), true);
  static_cast<void>(installed);

  if (file.empty()) throw OutputError("''", "cannot write to a file without a name", "a file name");
  if (name_ == "-") {  // standard output
    in_place_ = true;
    final_ = temporary_ = "/dev/stdout";
    descriptor_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    if (descriptor_ < 0) throw OutputError(name_, "cannot be opened: " + reason(), "an open standard output");
    return;
  }
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::directory || !file.has_filename()) {
    throw OutputError(name_, "is a directory", "the name of a file");
  }
  if (error == std::errc::filename_too_long) {
    throw OutputError(name_, "cannot be created: " + error.message(), "a shorter name");
  }
  const bool exists = fs::exists(status);
  if (exists && ::access(file.c_str(), W_OK) != 0) {
    throw OutputError(name_, "cannot be written: " + reason(), "a file that may be written");
  }

  // A name that is not a regular file cannot be renamed to, and /dev/stdout must stay the file that the shell opened.
  in_place_ =
      (exists && status.type() != fs::file_type::regular) || name_.starts_with("/dev/") || name_.starts_with("/proc/");
  if (in_place_) {
    final_ = temporary_ = name_;
    descriptor_ = ::open(final_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOCTTY);
    if (descriptor_ < 0) throw OutputError(name_, "cannot be opened: " + reason(), "a file that can be written");
    return;
  }

  // An absolute path, because the program may change its folder before commit(); the target of a link, so that the link
  // stays.
  fs::path target = fs::absolute(file);
  if (exists) {
    target = fs::canonical(file);
  } else if (fs::is_symlink(fs::symlink_status(file, error))) {
    target = target.parent_path() / fs::read_symlink(file);
  }
  final_ = target.string();
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    static std::atomic<unsigned> number{0};
    const std::string hidden = ".rigtwin-" + std::to_string(::getpid()) + "-" + std::to_string(number++) + ".tmp";
    temporary_ = (target.parent_path() / hidden).string();
    slot_ = remember(temporary_);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) break;
    const int open_error = errno;
    forget(slot_);
    if (open_error != EEXIST || attempt > 1000) {
      throw OutputError(name_, std::string("cannot be created: ") + std::strerror(open_error),
                        "an existing folder that may be written");
    }
  }
  struct stat present {};
  if (exists && ::stat(final_.c_str(), &present) == 0) {
    // A replaced file keeps its permissions; some file systems have none.
    static_cast<void>(::fchmod(descriptor_, present.st_mode & 07777U));
  }
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::write(std::string_view bytes) {
  if (buffer_.empty() && bytes.size() >= buffer_size) {
    buffer_.assign(bytes);
    flush();
    return;
  }
  buffer_ += bytes;
  if (buffer_.size() >= buffer_size) flush();
}

void OutputFile::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const std::string why = written < 0 ? reason() : "nothing more is taken";
      discard();
      throw OutputError(name_, "cannot be written: " + why, "room for the whole file");
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  buffer_.clear();
}

void OutputFile::commit() {
  flush();
  // A pipe or a terminal cannot be synchronised (EINVAL, EROFS); a failing disk is an error.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS && errno != ENOTSUP) {
    const std::string why = reason();
    discard();
    throw OutputError(name_, "cannot be written: " + why, "a disk that keeps the file");
  }
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0 && errno != EINTR) {
    const std::string why = reason();
    discard();
    throw OutputError(name_, "cannot be written: " + why, "room for the whole file");
  }
  if (in_place_) return;
  if (std::rename(temporary_.c_str(), final_.c_str()) != 0) {
    const std::string why = reason();
    discard();
    throw OutputError(name_, "cannot be given its name: " + why, "a name that may be written");
  }
  forget(slot_);
  temporary_.clear();
}

void OutputFile::discard() noexcept {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  buffer_.clear();
  if (in_place_ || temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  forget(slot_);
  temporary_.clear();
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  OutputFile output(file);
  output.write(bytes);
  output.commit();
}

}  // namespace firmware
