#include "tests/support/without_heap.hpp"

#include <gtest/gtest-spi.h>

#include <cstdlib>
#include <new>

namespace {

// The proof that the loop takes no heap is worth as much as its counter: every way to the heap must be seen.
// (Called as functions: a compiler may leave out a new-expression whose memory nobody looks at.)
TEST(WithoutHeap, SeesNewInEveryForm) {
  const std::size_t before = support::allocations();
  void* const one = ::operator new(8);
  EXPECT_EQ(support::allocations() - before, 1U);
  void* const many = ::operator new[](64);
  EXPECT_EQ(support::allocations() - before, 2U);
  void* const wide = ::operator new (256, std::align_val_t{128});
  EXPECT_EQ(support::allocations() - before, 3U);
  void* const quiet = ::operator new(8, std::nothrow);
  EXPECT_EQ(support::allocations() - before, 4U);
  ::operator delete(one);
  ::operator delete[](many);
  ::operator delete (wide, std::align_val_t{128});
  ::operator delete(quiet);
}

// Eigen takes its memory by malloc, not by new.
TEST(WithoutHeap, SeesMalloc) {
  if (!support::counts_malloc()) GTEST_SKIP() << "a sanitizer has malloc, or this is not glibc";
  const std::size_t before = support::allocations();
  void* volatile memory = std::malloc(16);
  memory = std::realloc(memory, 32);
  EXPECT_EQ(support::allocations() - before, 2U);
  std::free(memory);
  void* volatile zeros = std::calloc(2, 8);
  EXPECT_EQ(support::allocations() - before, 3U);
  std::free(zeros);
}

// A seal that nobody notices when broken is none.
TEST(WithoutHeap, FailsTheTestThatAllocates) {
  EXPECT_NONFATAL_FAILURE(
      {
        void* const memory = support::without_heap([] { return ::operator new(8); });
        ::operator delete(memory);
      },
      "heap is sealed");
}

TEST(WithoutHeap, HandsTheResultThrough) {
  int x = 3;
  int& same = support::without_heap([&]() -> int& { return x; });
  EXPECT_EQ(&same, &x);
}

}  // namespace
