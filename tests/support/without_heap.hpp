// Fails a test that touches the heap where it must not.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <type_traits>

namespace support {

/// Allocations of this thread so far: operator new in every form; malloc, calloc and realloc too, except under a
/// sanitizer (which replaces them itself).
[[nodiscard]] std::size_t allocations();

/// True when malloc and its relatives are counted too.
[[nodiscard]] bool counts_malloc();

/// The result of `work`; the test fails when it has allocated anything.
template <class Work>
decltype(auto) without_heap(Work&& work) {
  struct Watch {
    Watch() = default;
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    ~Watch() {
      const std::size_t allocated = allocations() - before;
      EXPECT_EQ(allocated, 0U) << "allocations where the heap is sealed";
    }
    std::size_t before = allocations();
  } watch;
  return work();
}

}  // namespace support
