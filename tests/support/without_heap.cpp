#include "tests/support/without_heap.hpp"

#include <cstdlib>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SUPPORT_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define SUPPORT_SANITIZED 1
#endif
#endif

#if defined(__GLIBC__) && !defined(SUPPORT_SANITIZED)
#define SUPPORT_COUNTS_MALLOC 1
#endif

namespace {

thread_local std::size_t counted = 0;

void* obtain(std::size_t size) {
#ifndef SUPPORT_COUNTS_MALLOC
  ++counted;  // else malloc counts it
#endif
  return std::malloc(size > 0 ? size : 1);
}

void* obtain_aligned(std::size_t size, std::align_val_t alignment) {
  ++counted;
  const auto step = static_cast<std::size_t>(alignment);
  return std::aligned_alloc(step, (size + step - 1) / step * step);
}

void* or_throw(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

namespace support {

std::size_t allocations() { return counted; }

bool counts_malloc() {
#ifdef SUPPORT_COUNTS_MALLOC
  return true;
#else
  return false;
#endif
}

}  // namespace support

#ifdef SUPPORT_COUNTS_MALLOC
extern "C" {
// NOLINTBEGIN(readability-identifier-naming): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
// NOLINTEND(readability-identifier-naming)

void* malloc(std::size_t size) {
  ++counted;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++counted;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++counted;
  return __libc_realloc(memory, size);
}
}
#endif

void* operator new(std::size_t size) { return or_throw(obtain(size)); }
void* operator new[](std::size_t size) { return or_throw(obtain(size)); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return obtain(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return obtain(size); }
void* operator new(std::size_t size, std::align_val_t alignment) { return or_throw(obtain_aligned(size, alignment)); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return or_throw(obtain_aligned(size, alignment)); }
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return obtain_aligned(size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return obtain_aligned(size, alignment);
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
