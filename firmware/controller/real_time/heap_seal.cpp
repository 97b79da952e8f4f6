#include "firmware/controller/real_time/heap_seal.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace firmware::controller {
namespace {
thread_local bool is_sealed = false;
thread_local std::uint64_t broken = 0;
}  // namespace

void seal_heap(bool sealed) { is_sealed = sealed; }
std::uint64_t broken_seals() { return broken; }

namespace {
[[maybe_unused]] void look() {  // not where a sanitizer has a malloc of its own
  if (is_sealed) ++broken;
}
}  // namespace
}  // namespace firmware::controller

#if defined(__SANITIZE_ADDRESS__)
#define RIGTWIN_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define RIGTWIN_SANITIZED 1
#endif
#endif

#if defined(__GLIBC__) && !defined(RIGTWIN_SANITIZED)  // a sanitizer replaces malloc itself
// The program's malloc is the C library's with a look at the seal: libraries written in C are seen as well.
extern "C" {
// NOLINTBEGIN(readability-identifier-naming): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* malloc(std::size_t size) {
  firmware::controller::look();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  firmware::controller::look();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  firmware::controller::look();
  return __libc_realloc(memory, size);
}
// Blocks with an alignment, as operator new(std::align_val_t) takes them.
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
void* memalign(std::size_t alignment, std::size_t size) {
  firmware::controller::look();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  firmware::controller::look();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  firmware::controller::look();
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) return EINVAL;
  void* block = __libc_memalign(alignment, size);
  if (block == nullptr) return ENOMEM;
  *memory = block;
  return 0;
}
void free(void* memory) {
  if (memory != nullptr) firmware::controller::look();  // free(nullptr) touches no heap
  __libc_free(memory);
}
// NOLINTEND(readability-identifier-naming)
}
#endif
