// Noise that is normal, and the same on every machine.
#include "firmware/simulation/gaussian.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace {

using firmware::Gaussian;

std::vector<double> samples(std::uint64_t seed, std::uint32_t stream, std::size_t count) {
  Gaussian gaussian(seed, stream);
  std::vector<double> values(count);
  for (double& value : values) value = gaussian();
  return values;
}

// Point. Within 2 ulp of the C library (itself within 1 ulp) over all normal numbers that the polar method can meet,
// the exact cases exactly.
TEST(Gaussian, TakesLogarithmsByItself) {
  EXPECT_EQ(Gaussian::logarithm(1.0), 0.0);
  std::uint64_t bits = 1;
  for (int i = 0; i < 20000; ++i) {
    bits = bits * 6364136223846793005U + 1442695040888963407U;
    const double m = 1.0 + static_cast<double>(bits >> 12U) * 0x1p-52;
    const double x = std::ldexp(m, -static_cast<int>(bits % 110));
    const double expected = std::log(x);
    const double ulp = std::nextafter(std::abs(expected), std::numeric_limits<double>::infinity()) - std::abs(expected);
    ASSERT_NEAR(Gaussian::logarithm(x), expected, 3.0 * ulp) << "x = " << x;
  }
  for (const double x :
       {0.5, 1.4142135623730950, 1.4142135623730952, 0.9999999999999999, 0x1p-104, 2.2250738585072014e-308}) {
    EXPECT_NEAR(Gaussian::logarithm(x), std::log(x), 4.5e-16 * std::abs(std::log(x))) << x;
  }
}

// Golden: the sequence belongs to the trace of every run; whoever changes it changes all recordings.
TEST(Gaussian, KeepsItsSequence) {
  const auto values = samples(1, 1, 4);
  EXPECT_EQ(values[0], -0x1.1e97877a8cda4p+1);
  EXPECT_EQ(values[1], 0x1.3f52ef4b66747p+0);
  EXPECT_EQ(values[2], 0x1.361a57c9a8b4ap+0);
  EXPECT_EQ(values[3], 0x1.772af6a6296a2p-1);
}

// Law. Moments of N = 200 000 normal samples: mean ± 1/√N, variance 1 ± √(2/N), skewness ± √(6/N), fourth moment 3 ±
// √(96/N), correlation of neighbours ± 1/√N; four standard errors each (1 in 16 000).
TEST(Gaussian, IsNormalAndWhite) {
  constexpr double n = 200000.0;
  for (const std::uint64_t seed : {1U, 2U, 77U}) {
    const auto x = samples(seed, 1, static_cast<std::size_t>(n));
    double mean = 0.0, square = 0.0, cube = 0.0, fourth = 0.0, neighbours = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      mean += x[i];
      square += x[i] * x[i];
      cube += x[i] * x[i] * x[i];
      fourth += x[i] * x[i] * x[i] * x[i];
      if (i > 0) neighbours += x[i] * x[i - 1];
    }
    EXPECT_NEAR(mean / n, 0.0, 4.0 / std::sqrt(n)) << "seed " << seed;
    EXPECT_NEAR(square / n, 1.0, 4.0 * std::sqrt(2.0 / n)) << "seed " << seed;
    EXPECT_NEAR(cube / n, 0.0, 4.0 * std::sqrt(15.0 / n)) << "seed " << seed;
    EXPECT_NEAR(fourth / n, 3.0, 4.0 * std::sqrt(96.0 / n)) << "seed " << seed;
    EXPECT_NEAR(neighbours / n, 0.0, 4.0 / std::sqrt(n)) << "seed " << seed;
  }
}

// Law. χ² of 32 classes of equal probability: 31 ± √62, five of them.
TEST(Gaussian, FillsEveryClassAlike) {
  constexpr std::size_t classes = 32, n = 64000;
  std::array<double, classes> found{};
  for (const double x : samples(5, 1, n)) {
    const double share = 0.5 * std::erfc(-x / std::sqrt(2.0));
    found[std::min<std::size_t>(classes - 1, static_cast<std::size_t>(share * classes))] += 1.0;
  }
  double chi2 = 0.0;
  const double expected = static_cast<double>(n) / classes;
  for (const double count : found) chi2 += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi2, 31.0 + 5.0 * std::sqrt(62.0));
}

// Road and sensors share a seed, not their numbers; both halves of a seed count. Independent sequences of N samples
// correlate by ± 1/√N.
TEST(Gaussian, KeepsSeedsAndStreamsApart) {
  constexpr std::size_t n = 20000;
  const auto base = samples(1, 1, n);
  EXPECT_EQ(base, samples(1, 1, n));
  for (const auto& other : {samples(1, 2, n), samples(2, 1, n), samples(1 + (std::uint64_t{1} << 32U), 1, n)}) {
    double product = 0.0;
    for (std::size_t i = 0; i < n; ++i) product += base[i] * other[i];
    EXPECT_NEAR(product / n, 0.0, 4.0 / std::sqrt(static_cast<double>(n)));
  }
}

}  // namespace
