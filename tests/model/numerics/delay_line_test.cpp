#include "model/numerics/delay_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace delay_line_test {
namespace {

using model::Stroke;
using ScalarLine = model::DelayLine<double, 64>;
using StrokeLine = model::DelayLine<Stroke<double>, 64>;

constexpr double h = 1e-3;

// Point (1). A whole delay gives back what was pushed, to the bit, from none to the longest, and before that the start.
TEST(DelayLine, GivesBackWhatWasPushedAWholeDelayAgo) {
  for (std::size_t delay = 0; delay <= ScalarLine::longest; ++delay) {
    ScalarLine line;
    line.start(-7.5, static_cast<double>(delay));
    for (std::size_t k = 0; k < 200; ++k) {
      line.push(0.1 * static_cast<double>(k));
      EXPECT_EQ(line.read(h), k < delay ? -7.5 : 0.1 * static_cast<double>(k - delay)) << delay << " samples";
    }
  }
}

// Point (1). 10 ms at 1 kHz are ten samples, though 0.010/0.001 is not 10 in binary; and a delay that misses a whole
// number by more than rounding is none.
TEST(DelayLine, TakesADelayThatIsWholeButForRoundingAsWhole) {
  ScalarLine line;
  line.start(0.0, 0.3 / 0.1);  // 2.9999999999999996
  line.push(1.0);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(line.read(h), 0.0);
    line.push(5.0 + k);
  }
  EXPECT_EQ(line.read(h), 1.0);
}

double cubic(double t) { return 2.0 - 3.0 * t + 0.5 * t * t - 0.125 * t * t * t; }
double cubic_rate(double t) { return -3.0 + t - 0.375 * t * t; }

// Point (2). Between samples cubics come back exactly, inside the line and at its newest end (d < 1), by Lagrange and
// by Hermite. 1e-10: rounding of numbers around 1e4 times some four terms.
TEST(DelayLine, InterpolatesCubicsExactly) {
  for (const double delay : {0.25, 0.5, 0.9, 1.25, 1.5, 7.125, 59.75}) {
    ScalarLine scalar;
    StrokeLine stroke;
    scalar.start(0.0, delay);
    stroke.start({}, delay);
    for (int k = 0; k < 80; ++k) {
      scalar.push(cubic(k));
      stroke.push({cubic(k), cubic_rate(k)});
    }
    EXPECT_NEAR(scalar.read(1.0), cubic(79.0 - delay), 1e-10) << delay;
    const Stroke<double> read = stroke.read(1.0);  // one time unit a sample
    EXPECT_NEAR(read.position, cubic(79.0 - delay), 1e-10) << delay;
    EXPECT_NEAR(read.velocity, cubic_rate(79.0 - delay), 1e-10) << delay;
  }
}

/// Largest error of a delayed sine of ω = 100 1/s with n samples per 1/16 s, the delay being (n/4 + ½) samples.
template <class Line>
double error_at(double period, double fraction) {
  constexpr double omega = 100.0;
  const double delay = 4.0 + fraction;
  Line line;
  double worst = 0.0;
  const auto value = [&](double t) {
    if constexpr (std::is_same_v<Line, ScalarLine>) {
      return std::sin(omega * t);
    } else {
      return Stroke<double>{std::sin(omega * t), omega * std::cos(omega * t)};
    }
  };
  line.start(value(0.0), delay);
  for (int k = 0; k < static_cast<int>(0.2 / period); ++k) {
    line.push(value(k * period));
    if (k < 10) continue;
    const double exact = std::sin(omega * (k - delay) * period);
    double read;
    if constexpr (std::is_same_v<Line, ScalarLine>) {
      read = line.read(period);
    } else {
      read = line.read(period).position;
    }
    worst = std::fmax(worst, std::fabs(read - exact));
  }
  return worst;
}

// Order (2). Halving the period divides the error by 16, and its size is that of the comment: 3/128 h⁴ω⁴ for Lagrange
// in the middle of its four samples, h⁴ω⁴/384 for Hermite.
TEST(DelayLine, HasAnErrorOfFourthOrder) {
  const double lagrange = error_at<ScalarLine>(1e-3, 0.5), hermite = error_at<StrokeLine>(1e-3, 0.5);
  EXPECT_NEAR(error_at<ScalarLine>(2e-3, 0.5) / lagrange, 16.0, 0.5);
  EXPECT_NEAR(error_at<StrokeLine>(2e-3, 0.5) / hermite, 16.0, 0.5);
  EXPECT_NEAR(lagrange / (3.0 / 128.0 * 1e-4), 1.0, 0.02);
  EXPECT_NEAR(hermite / (1.0 / 384.0 * 1e-4), 1.0, 0.02);
}

// Point. Below one sample the four newest are all there is: (r − 0)(…)/24 h⁴, at most 1/24 h⁴ max|u⁗|.
TEST(DelayLine, KeepsItsBoundAtTheNewestEnd) {
  constexpr double omega = 100.0;
  ScalarLine line;
  line.start(0.0, 0.4);
  double worst = 0.0;
  for (int k = 0; k < 300; ++k) {
    line.push(std::sin(omega * k * h));
    if (k > 5) worst = std::fmax(worst, std::fabs(line.read(h) - std::sin(omega * (k - 0.4) * h)));
  }
  EXPECT_LT(worst, 1e-4 / 24.0 * 1.01);
  EXPECT_GT(worst, 1e-4 / 24.0 * 0.5);
}

// Law. A delay that changes while running never jumps: fed with time itself, what is read is time, growing always by
// 1 ± slide samples, until the new delay is reached exactly.
TEST(DelayLine, SlidesToANewDelayWithoutAJumpInTime) {
  for (const double target : {17.0, 3.0, 0.0, 12.25, 60.0}) {
    StrokeLine line;
    line.start({0.0, 1.0}, 10.0);
    int k = 0;
    for (; k < 70; ++k) line.push({static_cast<double>(k), 1.0});
    double before = line.read(1.0).position;
    EXPECT_EQ(before, k - 1.0 - 10.0);
    line.set(target);
    EXPECT_EQ(line.read(1.0).position, before) << "setting alone moves nothing";
    for (int i = 0; i < 500; ++i, ++k) {
      line.push({static_cast<double>(k), 1.0});
      const double now = line.read(1.0).position;
      EXPECT_GE(now - before, 1.0 - StrokeLine::slide - 1e-12) << "sample " << i;
      EXPECT_LE(now - before, 1.0 + StrokeLine::slide + 1e-12) << "sample " << i;
      before = now;
    }
    EXPECT_EQ(line.delay(), target);
    EXPECT_NEAR(before, k - 1.0 - target, 1e-12);
  }
}

// Law. While sliding up to a whole delay and back, the line is again exact at the end: no rest of a fraction stays.
TEST(DelayLine, IsExactAgainAfterSliding) {
  ScalarLine line;
  line.start(0.0, 4.0);
  line.set(5.0);
  for (int k = 0; k < 100; ++k) line.push(std::sin(0.7 * k));
  EXPECT_EQ(line.read(h), std::sin(0.7 * 94));
  EXPECT_EQ(line.ago(0), std::sin(0.7 * 99));
}

// Fault. Longer than the ring, negative or no number: an assumption of ours is broken.
TEST(DelayLineDeathTest, StopsAtADelayBeyondItsCapacity) {
  ScalarLine line;
  EXPECT_DEATH(line.start(0.0, 60.5), "");
  EXPECT_DEATH(line.start(0.0, -0.1), "");
  EXPECT_DEATH(line.set(std::numeric_limits<double>::quiet_NaN()), "");
  line.start(0.0, 60.0);  // the longest is allowed
}

}  // namespace
}  // namespace delay_line_test
