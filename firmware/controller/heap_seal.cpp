#include "firmware/controller/heap_seal.hpp"

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
// NOLINTEND(readability-identifier-naming)
}
#endif
