// More samples of a signal.
#include "host_sim/signal/interpolation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace host_sim;

// Law. A sine below 0.45 of the sample rate is found between its samples; the samples themselves are untouched.
TEST(Interpolation, FindsTheSineBetweenItsSamples) {
  constexpr std::size_t factor = 5, count = 400;
  const Interpolation interpolation(factor);
  for (const double f : {0.0, 0.01, 0.2, 0.4, 0.45}) {  // of the sample rate
    const auto sine = [f](double k) { return std::cos(2.0 * std::numbers::pi * f * k + 0.3); };
    std::vector<double> samples(count);
    for (std::size_t k = 0; k < count; ++k) samples[k] = sine(static_cast<double>(k));
    const std::vector<double> finer = interpolation(samples);
    ASSERT_EQ(finer.size(), factor * (count - 1) + 1);
    for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(finer[factor * k], samples[k]);
    for (std::size_t k = factor * 32; k + factor * 32 < finer.size(); ++k) {
      ASSERT_NEAR(finer[k], sine(static_cast<double>(k) / factor), 3e-5) << f << " of the rate, " << k;
    }
  }
}

// Point. A straight line stays one up to its ends, where it is continued as its own image.
TEST(Interpolation, KeepsALineUpToItsEnds) {
  std::vector<double> line(100);
  for (std::size_t k = 0; k < line.size(); ++k) line[k] = 3.0 + 0.5 * static_cast<double>(k);
  const std::vector<double> finer = Interpolation(4)(line);
  for (std::size_t k = 0; k < finer.size(); ++k) EXPECT_NEAR(finer[k], 3.0 + 0.125 * static_cast<double>(k), 1e-3) << k;
  EXPECT_EQ(continued({1.0, 2.0, 4.0}, 2), (std::vector<double>{-2.0, 0.0, 1.0, 2.0, 4.0, 6.0, 7.0}));
  EXPECT_EQ(Interpolation(1)(line), line);
  EXPECT_TRUE(continued({}, 3).empty());
}

}  // namespace
