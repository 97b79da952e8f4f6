// The lowest point of a valley.
#include "host_sim/identification/common/golden_section.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace host_sim;

// Law. n rounds of golden section leave 0.618ⁿ of the range around the lowest point, also where that is an end.
TEST(GoldenSection, ClosesInOnTheLowestPoint) {
  for (const double lowest : {-1.0, -0.37, 0.002, 0.61, 2.0}) {
    const auto valley = [lowest](double x) { return std::abs(x - lowest) + 0.5; };
    for (const int rounds : {0, 5, 30}) {
      const identification::LowestPoint found = identification::golden_section(valley, -1.0, 2.0, rounds);
      EXPECT_NEAR(found.at, lowest, 3.0 * std::pow(0.6180339887498949, rounds + 1) + 1e-9) << lowest << " " << rounds;
      EXPECT_EQ(found.value, valley(found.at));
    }
  }
}

}  // namespace
