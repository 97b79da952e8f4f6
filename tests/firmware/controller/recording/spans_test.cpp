#include "firmware/controller/recording/spans.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace {

// The layout of cyclictest 2.4, `-h` with three threads, rows without any span left out. Each span stands in its own
// microsecond: its class, up to 3 % wide, is cut to the highest span.
TEST(Spans, AreWrittenAsCyclictestDoes) {
  const auto spans = std::make_unique<firmware::controller::Spans>();
  for (const int wake_up : {5100, 5100, 12'000}) spans->wake_up.add(wake_up);
  for (const int step : {900, 1900}) spans->step.add(step);
  spans->age.add(5200);
  EXPECT_EQ(firmware::controller::as_cyclictest(*spans),
            "# wake-up latency, step time, sample age [us]\n"
            "# Histogram\n"
            "000000 000000\t000001\t000000\n"
            "000001 000000\t000001\t000000\n"
            "000005 000002\t000000\t000001\n"
            "000012 000001\t000000\t000000\n"
            "# Total: 000000003 000000002 000000001\n"
            "# Min Latencies: 00005 00000 00005\n"
            "# Avg Latencies: 00007 00001 00005\n"
            "# Max Latencies: 00012 00001 00005\n");
}

TEST(Spans, SumUpInALine) {
  const auto spans = std::make_unique<firmware::controller::Spans>();
  for (int i = 0; i < 1000; ++i) spans->step.add(i < 500 ? 1000 : 2000);
  EXPECT_EQ(
      firmware::controller::line("step time", spans->step),
      "  step time         C:    1000 Min:      1.0 P50:      1.0 P99:      2.0 P99.9:      2.0 Max:      2.0 us\n");
}

}  // namespace
