// What the loop took, for those who know cyclictest.
#pragma once

#include <string>

#include "firmware/controller/recording/histogram.hpp"

namespace firmware::controller {

struct Spans {
  Histogram wake_up;  ///< how late the thread ran after its sleep
  Histogram step;     ///< the period itself, without sleeping
  Histogram age;      ///< of a period's oldest sample
};

/// "  step time         C:   30000 Min:      0.9 P50: …  P99: …  P99.9: …  Max: …  us"
[[nodiscard]] std::string line(const char* what, const Histogram& histogram);

/// The file that `cyclictest -h` writes, with wake-up latency, step time and sample age as its three threads: how many
/// spans ended in each microsecond (of those that hold any; beyond 32 µs each span counts up to 3 % too long), then
/// total, min, avg and max.
[[nodiscard]] std::string as_cyclictest(const Spans& spans);

}  // namespace firmware::controller
