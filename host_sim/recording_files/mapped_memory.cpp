#include "host_sim/recording_files/mapped_memory.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "firmware/description/text/input_error.hpp"

namespace host_sim {
namespace {

constexpr std::size_t address_range = std::size_t{8} << 40U;  // [byte] reserved for blocks: addresses, not memory
constexpr std::size_t most_mappings = 8192;
constexpr long look_every_ns = 5'000'000;

struct Mapping {
  std::byte* begin;
  std::size_t size;
};

// All mappings whose pages may be given back. It must not allocate: operator new calls it.
class Mappings {
 public:
  bool add(void* begin, std::size_t size) noexcept {
    const Lock lock(mutex_);
    if (count_ == most_mappings) return false;
    list_[count_++] = {static_cast<std::byte*>(begin), size};
    start_keeper();
    return true;
  }

  // Its size; 0: there is none.
  std::size_t remove(void* begin) noexcept {
    const Lock lock(mutex_);
    for (std::size_t i = count_; i-- > 0;) {
      if (list_[i].begin != begin) continue;
      const std::size_t size = list_[i].size;
      list_[i] = list_[--count_];
      return size;
    }
    return 0;
  }

  void give_pages_back() noexcept {
    const Lock lock(mutex_);
    for (std::size_t i = 0; i < count_; ++i) ::madvise(list_[i].begin, list_[i].size, MADV_DONTNEED);
  }

  // Around a fork: the child has neither the thread nor a holder of the lock.
  void lock() noexcept { ::pthread_mutex_lock(&mutex_); }
  void unlock() noexcept { ::pthread_mutex_unlock(&mutex_); }
  void be_child() noexcept {
    keeps_ = false;
    unlock();
  }

 private:
  class Lock {
   public:
    explicit Lock(pthread_mutex_t& mutex) noexcept : mutex_(mutex) { ::pthread_mutex_lock(&mutex_); }
    ~Lock() { ::pthread_mutex_unlock(&mutex_); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    pthread_mutex_t& mutex_;
  };

  void start_keeper() noexcept {
    if (keeps_) return;
    pthread_attr_t attributes{};
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    pthread_t thread{};
    keeps_ = ::pthread_create(&thread, &attributes, keep_resident_memory_small, this) == 0;
    ::pthread_attr_destroy(&attributes);
  }

  static std::size_t resident_memory(int statm) noexcept {
    std::array<char, 64> text{};
    if (::pread(statm, text.data(), text.size() - 1, 0) <= 0) return 0;
    const char* second = std::strchr(text.data(), ' ');
    return second == nullptr ? 0
                             : std::strtoull(second, nullptr, 10) * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  }

  static void* keep_resident_memory_small(void* self) noexcept {
    const int statm = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    for (;;) {
      const timespec pause{0, look_every_ns};
      ::nanosleep(&pause, nullptr);
      if (resident_memory(statm) > most_resident) static_cast<Mappings*>(self)->give_pages_back();
    }
  }

  pthread_mutex_t mutex_ = PTHREAD_MUTEX_INITIALIZER;
  std::array<Mapping, most_mappings> list_{};
  std::size_t count_ = 0;
  bool keeps_ = false;
};

// Constructed before any other object and never destroyed: blocks are released until the program has ended.
constinit Mappings mappings{};
constinit std::atomic<bool> in_files{false};
constinit std::atomic<std::uintptr_t> range_begin{0};  // of the addresses of blocks; 0: not reserved yet
constinit std::atomic<std::size_t> range_used{0};
constinit std::atomic<int> folder{-1};  // for temporary files

std::size_t whole_pages(std::size_t size) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return (size + page - 1) / page * page;
}

// A folder on a disk: files of a file system in memory would save none.
int open_folder() {
  constexpr long tmpfs = 0x01021994, ramfs = 0x858458f6;
  const char* const wanted = std::getenv("TMPDIR");
  for (const char* const name : {wanted, "/var/tmp", "/tmp"}) {
    if (name == nullptr || *name == '\0') continue;
    const int opened = ::open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    struct statfs status {};
    if (opened < 0) continue;
    if (::fstatfs(opened, &status) == 0 && status.f_type != tmpfs && status.f_type != ramfs) return opened;
    ::close(opened);
  }
  return -1;
}

int open_unnamed_file(std::size_t size) {
  if (folder < 0) return -1;
  int file = ::openat(folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) {  // not every file system has files without names
    static std::atomic<unsigned> number{0};
    std::array<char, 64> name{};
    std::snprintf(name.data(), name.size(), ".rigtwin-%ld-%u", static_cast<long>(::getpid()), number++);
    file = ::openat(folder, name.data(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file >= 0) ::unlinkat(folder, name.data(), 0);
  }
  // A disk that fills up later would end the program.
  if (file >= 0 && ::posix_fallocate(file, 0, static_cast<off_t>(size)) == 0) return file;
  if (file >= 0) ::close(file);
  return -1;
}

}  // namespace

void keep_large_blocks_in_files() {
  if (in_files) return;
  folder = open_folder();
  if (folder < 0) return;
  void* const range = ::mmap(nullptr, address_range, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (range == MAP_FAILED) return;
  range_begin = reinterpret_cast<std::uintptr_t>(range);
  ::pthread_atfork([] { mappings.lock(); }, [] { mappings.unlock(); }, [] { mappings.be_child(); });
  in_files = true;
}

bool large_blocks_are_in_files() noexcept { return in_files.load(std::memory_order_relaxed); }

void* take_file_block(std::size_t size) noexcept {
  const std::size_t length = whole_pages(size);
  const std::size_t at = range_used.fetch_add(length);
  if (at + length > address_range) return nullptr;
  const int file = open_unnamed_file(length);
  if (file < 0) return nullptr;
  void* const place = reinterpret_cast<void*>(range_begin.load() + at);  // NOLINT(performance-no-int-to-ptr)
  void* const block = ::mmap(place, length, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0);
  ::close(file);
  if (block == MAP_FAILED) return nullptr;
  if (mappings.add(block, length)) return block;
  ::mmap(place, length, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
  return nullptr;
}

bool release_file_block(void* block) noexcept {
  const std::uintptr_t begin = range_begin.load(std::memory_order_relaxed);
  if (begin == 0 || reinterpret_cast<std::uintptr_t>(block) - begin >= address_range) return false;
  const std::size_t size = mappings.remove(block);
  // The addresses stay reserved.
  ::mmap(block, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
  return true;
}

FileContents::FileContents(int descriptor, std::string_view head, std::string_view source) : read_(head) {
  constexpr std::size_t least_mapped = std::size_t{16} << 20U;
  constexpr std::size_t most_of_a_stream = std::size_t{2} << 30U;
  constexpr std::size_t block = std::size_t{1} << 20U;
  struct stat status {};
  const bool regular = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  if (regular && static_cast<std::size_t>(status.st_size) >= least_mapped) {
    size_ = static_cast<std::size_t>(status.st_size);
    void* const mapping = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (mapping != MAP_FAILED) {
      mapping_ = mapping;
      mappings.add(mapping, size_);
      ::madvise(mapping, size_, MADV_SEQUENTIAL);
      return;
    }
  }
  for (;;) {
    const std::size_t size = read_.size();
    if (size > most_of_a_stream)
      throw firmware::InputError(source, 0, "the stream is longer than 2 GiB", "a file, or a shorter recording");
    read_.resize(size + block);
    const ssize_t got = ::read(descriptor, read_.data() + size, block);
    read_.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw firmware::InputError(source, 0, std::string("cannot be read: ") + std::strerror(errno), "a readable file");
    if (got == 0) return;
  }
}

FileContents::~FileContents() {
  if (mapping_ == nullptr) return;
  mappings.remove(mapping_);
  ::munmap(mapping_, size_);
}

}  // namespace host_sim
