// Sliders that pull harder one way than the other.
#include "host_sim/identification/learn/sliding_sides.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/reference_road.hpp"

namespace {

using host_sim::identification::sliding_sides;
using host_sim::identification::Window;

/// Ten turns of 40 samples of a law of ± 100 N with ramps between, and what is measured: `push` and −`pull` in the
/// place of it, each pass off by `scatter` times a normal number.
struct Turns {
  std::vector<double> law, measured;
  Turns(double push, double pull, double scatter) {
    support::NormalNoise noise(7);
    for (int turn = 0; turn < 10; ++turn) {
      for (const double side : {1.0, -1.0}) {
        const double off = scatter * noise();
        for (int k = 0; k < 20; ++k) {
          const double share = k < 5 ? k / 5.0 : 1.0;
          law.push_back(side * share * 100.0);
          measured.push_back(side * share * (side > 0.0 ? push : pull) + off);
        }
      }
    }
  }
};

// Point. 90 N one way and 108 N the other: 20 % more, or an offset of −9 N. Passes that scatter by 2 N give means known
// to 2/√10 N, hence a ratio known to 1.96 √(1 + 1.2²) · 0.63/90, 2.2 %.
TEST(SlidingSides, SayHowMuchHarderReboundIs) {
  const Turns exact(90.0, 108.0, 0.0);
  const auto more = sliding_sides(exact.law, exact.measured, {0, exact.law.size()}, 100.0);
  ASSERT_TRUE(more);
  EXPECT_NEAR(more->more.value, 20.0, 1e-9);
  EXPECT_NEAR(more->offset, -9.0, 1e-12);
  const Turns rough(90.0, 108.0, 2.0);
  const auto about = sliding_sides(rough.law, rough.measured, {0, rough.law.size()}, 100.0);
  ASSERT_TRUE(about);
  EXPECT_NEAR(about->more.value, 20.0, 3.0 * 1.1);
  EXPECT_NEAR(about->more.upper - about->more.value, 2.2, 1.0);
}

// Law. Sides that differ by less than their scatter, too few passes, and a measured force of the wrong sign say
// nothing.
TEST(SlidingSides, SayNothingThatIsNotKnown) {
  const Turns alike(100.0, 101.0, 5.0);
  EXPECT_FALSE(sliding_sides(alike.law, alike.measured, {0, alike.law.size()}, 100.0));
  const Turns exact(90.0, 108.0, 0.0);
  EXPECT_FALSE(sliding_sides(exact.law, exact.measured, {0, 60}, 100.0));
  EXPECT_FALSE(sliding_sides(exact.law, exact.measured, {0, exact.law.size()}, 1000.0));
  const Turns wrong(-90.0, 108.0, 0.0);
  EXPECT_FALSE(sliding_sides(wrong.law, wrong.measured, {0, wrong.law.size()}, 100.0));
}

}  // namespace
