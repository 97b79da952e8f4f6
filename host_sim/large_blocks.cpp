// Large blocks of memory of the program rigtwin come from files where a command wants it so: see
// host_sim/recording_files/mapped_memory.hpp. The blocks of std::vector and std::string are all taken here.
#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "host_sim/recording_files/mapped_memory.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RIGTWIN_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define RIGTWIN_SANITIZED 1  // a sanitizer has its own operator new
#endif
#endif

#if defined(__GLIBC__) && !defined(RIGTWIN_SANITIZED)
namespace {
constexpr std::size_t slack = 64;                     // [byte] that malloc may give beyond what is asked for
constinit std::atomic<std::size_t> large_on_heap{0};  // [byte] by the size that malloc gave
}  // namespace

void* operator new(std::size_t size) {
  const bool large = size + slack >= host_sim::least_large_block;
  if (large && host_sim::large_blocks_are_in_files() &&
      large_on_heap.load(std::memory_order_relaxed) + size > host_sim::most_on_heap) {
    if (void* const block = host_sim::take_file_block(size)) return block;
  }
  void* const block = std::malloc(size > 0 ? size : 1);
  if (block == nullptr) throw std::bad_alloc();
  if (!large) return block;
  const std::size_t usable = ::malloc_usable_size(block);
  if (usable >= host_sim::least_large_block) large_on_heap.fetch_add(usable, std::memory_order_relaxed);
  return block;
}

void operator delete(void* block) noexcept {
  if (block == nullptr || host_sim::release_file_block(block)) return;
  const std::size_t size = ::malloc_usable_size(block);
  if (size >= host_sim::least_large_block) large_on_heap.fetch_sub(size, std::memory_order_relaxed);
  std::free(block);
}
void operator delete(void* block, std::size_t) noexcept { operator delete(block); }
#endif
