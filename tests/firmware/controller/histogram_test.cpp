#include "firmware/controller/histogram.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/without_heap.hpp"

namespace {

using firmware::controller::Histogram;

// 1 … 10 000 µs once each: the quantiles are known, up to the width of a class, 1/32.
TEST(Histogram, KnowsItsQuantiles) {
  const auto histogram = std::make_unique<Histogram>();
  EXPECT_EQ(histogram->quantile(0.5), 0U);
  for (int i = 1; i <= 10'000; ++i) histogram->add(1000 * i);
  EXPECT_EQ(histogram->count(), 10'000U);
  EXPECT_EQ(histogram->lowest(), 1000U);
  EXPECT_EQ(histogram->highest(), 10'000'000U);
  for (const double share : {0.01, 0.5, 0.99, 0.999}) {
    const double exact = share * 1e7;
    const auto found = static_cast<double>(histogram->quantile(share));
    EXPECT_GE(found, exact * (1.0 - 1e-9)) << "never too low: a limit is held against it";
    EXPECT_LE(found, exact * (1.0 + 1.0 / 32.0));
  }
  EXPECT_EQ(histogram->quantile(1.0), histogram->highest());
}

// Every span has a class that holds it, from nothing to centuries; a clock that ran back counts as nothing.
TEST(Histogram, HoldsEverySpan) {
  for (int bit = 0; bit < 63; ++bit) {
    for (const std::int64_t near : {-1, 0, 1}) {
      const std::int64_t span = (std::int64_t{1} << bit) + near;
      const auto histogram = std::make_unique<Histogram>();
      histogram->add(span);
      EXPECT_EQ(histogram->quantile(0.5), static_cast<std::uint64_t>(span)) << "one span: cut to the highest";
    }
  }
  const auto histogram = std::make_unique<Histogram>();
  histogram->add(-5);
  EXPECT_EQ(histogram->highest(), 0U);
}

TEST(Histogram, TakesNoHeap) {
  const auto histogram = std::make_unique<Histogram>();
  support::without_heap([&] { histogram->add(77); });
}

}  // namespace
