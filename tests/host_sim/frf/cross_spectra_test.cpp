// Auto and cross spectra against SciPy and against their laws.
#include "host_sim/frf/cross_spectra.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/host_sim/frf/scipy_numbers.hpp"
#include "tests/host_sim/frf/signals.hpp"

namespace {

using host_sim::frf::BlockScheme;
using host_sim::frf::Complex;
using host_sim::frf::CrossSpectra;
using support::white;

// Golden. scipy.signal.welch and csd for every window, three block lengths, overlaps and trends:
// tests/golden/frf_scipy.py made the file. To 1e-10 of the largest value: the two sum in different order, some 10⁴
// roundings of 1e-16.
TEST(CrossSpectra, AgreesWithScipy) {
  const support::ScipyNumbers scipy = support::scipy_numbers();
  ASSERT_EQ(scipy.spectra.size(), 12U);
  for (const auto& [scheme, lines] : scipy.spectra) {
    CrossSpectra spectra(scipy.rate, scheme, 2, 1);
    const host_sim::frf::ShiftedSignal signals[] = {{scipy.x}, {scipy.y}};
    spectra.add(signals);
    ASSERT_EQ(spectra.lines(), lines.size());
    double xx_scale = 0.0, yy_scale = 0.0;
    for (const auto& line : lines) {
      xx_scale = std::max(xx_scale, line.xx);
      yy_scale = std::max(yy_scale, line.yy);
    }
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const std::string where =
          std::string(name(scheme.window)) + " " + std::to_string(scheme.length) + ", line " + std::to_string(k);
      EXPECT_NEAR(spectra.frequency(k), lines[k].frequency, 1e-12) << where;
      EXPECT_NEAR(spectra.power(0, k), lines[k].xx, 1e-10 * xx_scale) << where;
      EXPECT_NEAR(spectra.power(1, k), lines[k].yy, 1e-10 * yy_scale) << where;
      EXPECT_LT(std::abs(spectra.cross(0, 1, k) - lines[k].xy), 1e-10 * std::sqrt(xx_scale * yy_scale)) << where;
    }
  }
}

// Law. Blocks are taken inside each recording and all count alike: two recordings of 3 and 5 blocks give the mean of
// their spectra with weights 3 and 5; a recording shorter than a block gives nothing.
TEST(CrossSpectra, JoinsRecordingsBlockByBlock) {
  const BlockScheme scheme{32, 16};
  const std::vector<double> x1 = white(64, 1.0, 1), y1 = white(64, 1.0, 2), x2 = white(100, 1.0, 3),
                            y2 = white(100, 1.0, 4), stub = white(31, 1.0, 5);
  const host_sim::frf::ShiftedSignal first[] = {{x1}, {y1}}, second[] = {{x2}, {y2}}, too_short[] = {{stub}, {stub}};
  CrossSpectra one(10.0, scheme, 2, 1), other(10.0, scheme, 2, 1), both(10.0, scheme, 2, 1);
  one.add(first);
  other.add(second);
  both.add(first);
  EXPECT_EQ(both.add(too_short), 0U);
  both.add(second);
  ASSERT_EQ(one.averages(), 3U);
  ASSERT_EQ(other.averages(), 5U);
  ASSERT_EQ(both.averages(), 8U);
  for (std::size_t k = 0; k < both.lines(); ++k) {
    EXPECT_LT(std::abs(both.cross(0, 1, k) - (3.0 * one.cross(0, 1, k) + 5.0 * other.cross(0, 1, k)) / 8.0), 1e-14);
  }
  // Independent recordings: variances of sums add. 64/ε₁ is not the sum of both: each has ends that overlap nothing.
  const double a = 9.0 / one.effective_averages(), b = 25.0 / other.effective_averages();
  EXPECT_NEAR(both.effective_averages(), 64.0 / (a + b), 1e-12);
  EXPECT_LT(both.effective_averages(), 8.0);
}

// Law. A shift s takes blocks s samples later: of a signal delayed by s it gives back the blocks of the signal itself,
// to the bit, for channels early and late in one recording.
TEST(CrossSpectra, TakesShiftedBlocks) {
  const std::vector<double> x = white(400, 1.0, 7);
  std::vector<double> late(x.size()), early(x.size());
  for (std::size_t n = 0; n < x.size(); ++n) {
    late[n] = n >= 9 ? x[n - 9] : 0.0;
    early[n] = n + 5 < x.size() ? x[n + 5] : 0.0;
  }
  CrossSpectra spectra(1.0, {64, 32}, 3, 1);
  const host_sim::frf::ShiftedSignal signals[] = {{x, 0}, {late, 9}, {early, -5}};
  EXPECT_EQ(spectra.add(signals), (400U - 14U - 64U) / 32U + 1U) << "blocks inside all three";
  for (std::size_t k = 0; k < spectra.lines(); ++k) {
    EXPECT_EQ(spectra.cross(0, 1, k), Complex(spectra.power(0, k)));
    EXPECT_EQ(spectra.cross(0, 2, k), Complex(spectra.power(0, k)));
  }
}

// Law. K_eff is what the scatter of estimates says: var Ŝ/S² = 1/K_eff for Gaussian noise, here from 400 recordings ×
// 60 lines of 128 samples in 12 blocks. The variance of a variance of that many is known to some 2 %, neighbouring
// lines being correlated; 6 %.
TEST(CrossSpectra, CountsOverlappingBlocksForWhatTheyAreWorth) {
  for (const std::size_t hop : {128U, 64U, 32U}) {
    double mean = 0.0, squares = 0.0, worth = 0.0;
    int count = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
      const std::vector<double> x = white(128 + 11 * hop, 1.0, seed);
      CrossSpectra spectra(1.0, {128, hop}, 1, 1);
      const host_sim::frf::ShiftedSignal signals[] = {{x}};
      spectra.add(signals);
      worth = spectra.effective_averages();
      for (std::size_t k = 2; k < 62; ++k, ++count) {
        mean += spectra.power(0, k);
        squares += spectra.power(0, k) * spectra.power(0, k);
      }
    }
    mean /= count;
    EXPECT_NEAR((squares / count / mean / mean - 1.0) * worth, 1.0, 0.06) << "hop " << hop << ", worth " << worth;
  }
}

TEST(CrossSpectra, RefusesWhatIsOurMistake) {
  EXPECT_THROW(CrossSpectra(1.0, {33, 16}, 2, 1), std::invalid_argument);
  EXPECT_THROW(CrossSpectra(1.0, {32, 0}, 2, 1), std::invalid_argument);
  EXPECT_THROW(CrossSpectra(1.0, {32, 33}, 2, 1), std::invalid_argument);
  EXPECT_THROW(CrossSpectra(0.0, {32, 16}, 2, 1), std::invalid_argument);
  CrossSpectra spectra(1.0, {32, 16}, 2, 1);
  const std::vector<double> x(64, 1.0), y(63, 1.0);
  const host_sim::frf::ShiftedSignal one[] = {{x}}, unequal[] = {{x}, {y}};
  EXPECT_THROW(static_cast<void>(spectra.add(one)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(spectra.add(unequal)), std::invalid_argument);
}

}  // namespace
