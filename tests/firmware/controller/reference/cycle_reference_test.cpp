#include "firmware/controller/reference/cycle_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using firmware::Motion;
using firmware::controller::CycleReference;

constexpr double h = 1e-3;
constexpr std::size_t n = 8000;  // 8 s, of which the last 2 s are faded into the next cycle

/// Ends 20 mm above its beginning, at another speed.
std::vector<Motion> table() {
  std::vector<Motion> motion(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = h * static_cast<double>(k), w = 7.0;
    motion[k] = {0.0025 * t + 0.01 * std::sin(w * t), 0.0025 + 0.01 * w * std::cos(w * t),
                 -0.01 * w * w * std::sin(w * t)};
  }
  return motion;
}

// One cycle is the table, bit by bit, and N cycles take n + (N − 1)(n − B) samples.
TEST(CycleReference, HasTheLengthOfItsCycles) {
  const auto motion = table();
  CycleReference once(motion, 1, h);
  for (std::size_t k = 0; k < n; ++k) EXPECT_EQ(once.at(k)->position, motion[k].position);
  EXPECT_FALSE(once.at(n).has_value());

  CycleReference thrice(motion, 3, h);
  EXPECT_EQ(thrice.cycle_samples(), 6000U);
  EXPECT_TRUE(thrice.at(2 * 6000 + n - 1).has_value());
  EXPECT_FALSE(thrice.at(2 * 6000 + n).has_value());
  EXPECT_EQ(thrice.at(2 * 6000 + n - 1)->position, motion[n - 1].position) << "the end is that of the table";
}

// Law. The joint has no jump: position, velocity and acceleration belong together everywhere, by differences over the
// joints as elsewhere. The third derivative is at most 0.01 · 7³ = 3.4 m/s³ and that of the blend below 1 m/s³, so a
// step of 1 ms changes the acceleration by less than 0.005 m/s².
TEST(CycleReference, JoinsWithoutAJump) {
  const auto motion = table();
  CycleReference reference(motion, 4, h);
  Motion before = *reference.at(0);
  for (std::uint64_t k = 1; k < 3 * 6000 + n; ++k) {
    const Motion now = *reference.at(k);
    ASSERT_NEAR(now.position, before.position + 0.5 * h * (before.velocity + now.velocity), 1e-9) << k;
    ASSERT_NEAR(now.velocity, before.velocity + 0.5 * h * (before.acceleration + now.acceleration), 1e-6) << k;
    ASSERT_NEAR(now.acceleration, before.acceleration, 0.005) << k;
    before = now;
  }
}

// 0 cycles: without end, far beyond what a table of ten million samples holds.
TEST(CycleReference, GoesOnWithoutEnd) {
  const auto motion = table();
  CycleReference endless(motion, 0, h);
  const std::uint64_t far = std::uint64_t{6000} * 1'000'000'000;
  EXPECT_EQ(endless.at(far + 3000)->position, motion[3000].position);
}

// A short road blends a quarter of itself; one of a single sample stands still.
TEST(CycleReference, TakesShortRoads) {
  const std::vector<Motion> short_road(8, Motion{0.01, 0.0, 0.0}), one(1, Motion{0.02, 0.0, 0.0});
  EXPECT_EQ(CycleReference(short_road, 2, h).cycle_samples(), 6U);
  CycleReference single(one, 0, h);
  EXPECT_EQ(single.at(1000)->position, 0.02);
}

}  // namespace
