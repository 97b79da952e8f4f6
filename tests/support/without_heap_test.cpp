#include "tests/support/without_heap.hpp"

#include <gtest/gtest-spi.h>

#include <cstdlib>
#include <memory>

namespace {

// The proof that the loop takes no heap is worth as much as its counter: every way to the heap must be seen.
TEST(WithoutHeap, SeesNewInEveryForm) {
  const std::size_t before = support::allocations();
  const auto one = std::make_unique<int>(1);
  EXPECT_EQ(support::allocations() - before, 1U);
  const auto many = std::make_unique<double[]>(8);
  EXPECT_EQ(support::allocations() - before, 2U);
  struct alignas(128) Wide {
    double values[16];
  };
  const auto wide = std::make_unique<Wide>();
  EXPECT_EQ(support::allocations() - before, 3U);
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
        const auto value = support::without_heap([] { return std::make_unique<int>(7); });
        EXPECT_EQ(*value, 7);
      },
      "heap is sealed");
}

TEST(WithoutHeap, HandsTheResultThrough) {
  int x = 3;
  int& same = support::without_heap([&]() -> int& { return x; });
  EXPECT_EQ(&same, &x);
}

}  // namespace
