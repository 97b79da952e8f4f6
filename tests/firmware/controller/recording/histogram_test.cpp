#include "firmware/controller/recording/histogram.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

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

// Law. The classes hold all spans, each not too long by more than 1/32; the mean is that of the spans themselves.
TEST(Histogram, ShowsItsClasses) {
  const auto histogram = std::make_unique<Histogram>();
  EXPECT_EQ(histogram->mean(), 0U);
  for (const int span : {3, 700, 700, 5000, 90'000}) histogram->add(span);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> found;
  histogram->for_each_class([&](std::uint64_t longest, std::uint64_t spans) { found.emplace_back(longest, spans); });
  ASSERT_EQ(found.size(), 4U);
  const std::vector<std::pair<std::uint64_t, std::uint64_t>> wanted{{3, 1}, {700, 2}, {5000, 1}, {90'000, 1}};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_GE(found[i].first, wanted[i].first);
    EXPECT_LE(found[i].first, wanted[i].first + wanted[i].first / 32);
    EXPECT_EQ(found[i].second, wanted[i].second);
  }
  EXPECT_EQ(histogram->mean(), (3U + 700U + 700U + 5000U + 90'000U) / 5U);
}

TEST(Histogram, TakesNoHeap) {
  const auto histogram = std::make_unique<Histogram>();
  support::without_heap([&] { histogram->add(77); });
}

}  // namespace
