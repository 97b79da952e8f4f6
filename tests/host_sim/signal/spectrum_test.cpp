// Spectra against what is known in closed form.
#include "host_sim/signal/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tests/host_sim/signal/normal_noise.hpp"

namespace {

using host_sim::good_fft_size;
using host_sim::PowerSpectrum;
using host_sim::RealTransform;
using host_sim::welch;
using sample::noise;

constexpr double pi = std::numbers::pi;

double power_of(const PowerSpectrum& spectrum) {
  return std::accumulate(spectrum.density.begin(), spectrum.density.end(), 0.0) * spectrum.frequency[1];
}

// Point. Even, of factors 2, 3, 5 only, and none smaller: by hand.
TEST(GoodFftSize, IsTheNextEvenNumberOfSmallFactors) {
  EXPECT_EQ(good_fft_size(0), 2U);
  EXPECT_EQ(good_fft_size(1), 2U);
  EXPECT_EQ(good_fft_size(2), 2U);
  EXPECT_EQ(good_fft_size(3), 4U);
  EXPECT_EQ(good_fft_size(7), 8U);
  EXPECT_EQ(good_fft_size(45), 48U);
  EXPECT_EQ(good_fft_size(60000), 60000U);
  EXPECT_EQ(good_fft_size(59999), 60000U);
  EXPECT_EQ(good_fft_size(14951), 15000U);
  EXPECT_EQ(good_fft_size(97), 100U);
}

TEST(GoodFftSize, IsFoundBelowToo) {
  EXPECT_EQ(host_sim::good_fft_size_at_most(2), 2U);
  EXPECT_EQ(host_sim::good_fft_size_at_most(3), 2U);
  EXPECT_EQ(host_sim::good_fft_size_at_most(47), 40U);
  EXPECT_EQ(host_sim::good_fft_size_at_most(60000), 60000U);
  EXPECT_EQ(host_sim::good_fft_size_at_most(59999), 58320U);
  EXPECT_THROW(static_cast<void>(host_sim::good_fft_size_at_most(1)), std::invalid_argument);
}

// Point. Windows at the beginning, a quarter and the middle of a block of eight, by hand; w_N would be w_0 again.
TEST(Windows, AreTheirFormulas) {
  using host_sim::WindowShape;
  const auto expect = [](WindowShape shape, double first, double quarter, double middle) {
    const std::vector<double> w = host_sim::make_window(shape, 8);
    ASSERT_EQ(w.size(), 8U);
    EXPECT_NEAR(w[0], first, 1e-15) << name(shape);
    EXPECT_NEAR(w[2], quarter, 1e-15) << name(shape);
    EXPECT_NEAR(w[4], middle, 1e-15) << name(shape);
    EXPECT_NEAR(w[7], w[1], 1e-15) << name(shape);
  };
  expect(WindowShape::hann, 0.0, 0.5, 1.0);
  expect(WindowShape::hamming, 0.08, 0.54, 1.0);
  expect(WindowShape::blackman, 0.0, 0.34, 1.0);
  expect(WindowShape::rectangular, 1.0, 1.0, 1.0);
}

// Law. What is taken from a block is gone: of a straight line nothing is left with `line`, its slope with `mean`, all
// with `none`.
TEST(BlockTransform, TakesTheTrendAway) {
  std::vector<double> line(20);
  for (std::size_t n = 0; n < line.size(); ++n) line[n] = 3.0 - 0.25 * static_cast<double>(n);
  const auto bins = [&](host_sim::Detrend detrend) {
    host_sim::BlockTransform transform(host_sim::make_window(host_sim::WindowShape::rectangular, 20), detrend);
    const auto x = transform(line);
    return std::pair(std::abs(x[0]), std::abs(x[1]));
  };
  using host_sim::Detrend;
  EXPECT_NEAR(bins(Detrend::none).first, 20.0 * 0.625, 1e-12);
  EXPECT_NEAR(bins(Detrend::mean).first, 0.0, 1e-12);
  EXPECT_NEAR(bins(Detrend::mean).second, 0.25 * 20.0 / 2.0 / std::sin(pi / 20.0), 1e-12);
  EXPECT_NEAR(bins(Detrend::line).second, 0.0, 1e-12);
  host_sim::BlockTransform transform(host_sim::hann_window(20), Detrend::mean);
  EXPECT_THROW(static_cast<void>(transform(std::vector<double>(19))), std::invalid_argument);
}

// Point. Equation (1), summed as it stands, for every length there is a special case for. Both sums round by about
// N ε |x|.
TEST(RealTransform, IsTheDiscreteFourierTransform) {
  for (const std::size_t length : {2U, 4U, 6U, 8U, 10U, 14U, 30U, 48U, 60U, 62U, 100U}) {
    const std::vector<double> signal = noise(length, 1.0, 5);
    RealTransform transform(length);
    const auto bins = transform(signal);
    ASSERT_EQ(bins.size(), length / 2 + 1);
    for (std::size_t k = 0; k < bins.size(); ++k) {
      std::complex<double> sum = 0.0;
      for (std::size_t n = 0; n < length; ++n) {
        sum +=
            signal[n] * std::polar(1.0, -2.0 * pi * static_cast<double>(k * n % length) / static_cast<double>(length));
      }
      EXPECT_LT(std::abs(bins[k] - sum), 1e-15 * static_cast<double>(length) * 10.0) << length << ' ' << k;
    }
    EXPECT_EQ(bins.front().imag(), 0.0);
    EXPECT_EQ(bins.back().imag(), 0.0);
  }
}

// A shorter signal is followed by zeros, also after a longer one; an odd length or a longer signal is a mistake of
// ours.
TEST(RealTransform, PadsWithZerosAndRefusesOtherLengths) {
  RealTransform transform(8);
  static_cast<void>(transform(noise(8, 1.0, 1)));
  const std::vector<double> pulse{1.0};
  for (const std::complex<double> bin : transform(pulse)) EXPECT_LT(std::abs(bin - 1.0), 1e-15);
  EXPECT_THROW(static_cast<void>(transform(std::vector<double>(9))), std::invalid_argument);
  EXPECT_THROW(RealTransform{7}, std::invalid_argument);
  EXPECT_THROW(RealTransform{0}, std::invalid_argument);
}

// Law (Parseval). Of one segment the sum of the density is the variance of the windowed signal: Σ(w x)²/Σw², with
// Σw² = 3N/8 for Hann. Rounding only.
TEST(Welch, KeepsThePowerOfASegment) {
  for (const std::size_t length : {64U, 90U, 1000U}) {
    const std::vector<double> signal = noise(length, 3.0, 7);
    const PowerSpectrum spectrum = welch(signal, 500.0, length);
    ASSERT_EQ(spectrum.averages, 1U);
    const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(length);
    double power = 0.0;
    for (std::size_t n = 0; n < length; ++n) {
      const double w = 0.5 - 0.5 * std::cos(2.0 * pi * static_cast<double>(n) / static_cast<double>(length));
      power += std::pow(w * (signal[n] - mean), 2);
    }
    EXPECT_NEAR(power_of(spectrum) / (power / (0.375 * static_cast<double>(length))), 1.0, 1e-12);
    EXPECT_EQ(spectrum.frequency.back(), 250.0);
  }
}

// White noise of variance σ² sampled at f_s has the one-sided density 2σ²/f_s at every frequency. The mean over the
// bins averages 10⁶ numbers: 5 standard errors are 5 √(2/10⁶) ≈ 0.7 %. Single bins scatter by ε of (3), which their own
// scatter – known to 1/√(2·511) ≈ 3 % from 511 bins, a little worse since neighbours are correlated – must show: 15 %.
TEST(Welch, FindsTheLevelOfWhiteNoiseAndItsOwnStandardError) {
  const unsigned seed = 20;
  const std::vector<double> signal = noise(1000000, 2.0, seed);
  const PowerSpectrum spectrum = welch(signal, 1000.0, 1024);
  const double level = 2.0 * 4.0 / 1000.0;
  const std::size_t bins = spectrum.density.size();
  double mean = 0.0;
  double scatter = 0.0;
  for (std::size_t k = 2; k + 2 < bins; ++k) {
    mean += spectrum.density[k] / level / static_cast<double>(bins - 4);
    scatter += std::pow(spectrum.density[k] / level - 1.0, 2) / static_cast<double>(bins - 4);
  }
  EXPECT_NEAR(mean, 1.0, 7e-3) << "seed " << seed;
  EXPECT_NEAR(std::sqrt(scatter) / spectrum.relative_standard_error, 1.0, 0.15) << "seed " << seed;
  EXPECT_EQ(spectrum.averages, 2U * 1000000U / good_fft_size(1024) - 1U);
}

// Point. Equation (3): one segment has ε = 1, and Hann windows that overlap by half have ρ = (1/6)², so K segments
// are worth K/(1 + 2 (1 − 1/K)/36).
TEST(Welch, CountsOverlappingSegmentsForFewer) {
  const std::vector<double> window = host_sim::hann_window(4096);
  EXPECT_DOUBLE_EQ(host_sim::welch_standard_error(window, 2048, 1), 1.0);
  EXPECT_NEAR(host_sim::welch_standard_error(window, 2048, 10), std::sqrt((1.0 + 2.0 * 0.9 / 36.0) / 10.0), 1e-9);
  EXPECT_NEAR(host_sim::welch_standard_error(window, 4096, 10), std::sqrt(0.1), 1e-12);
}

// A sine of amplitude a in the middle of a bin has the power a²/2, in that bin and its two neighbours: a Hann line
// is 1.5 bins wide, so the middle one has (a²/2)/(1.5 Δf), its neighbours a quarter of that, and others nothing.
TEST(Welch, ShowsASineAsOneLine) {
  const std::size_t segment = 500;
  std::vector<double> signal(10000);
  for (std::size_t n = 0; n < signal.size(); ++n) {
    signal[n] = 7.0 + 3.0 * std::sin(2.0 * pi * 20.0 * static_cast<double>(n) / static_cast<double>(segment) + 0.3);
  }
  const PowerSpectrum spectrum = welch(signal, 1000.0, segment);
  const double line = 4.5 / (1.5 * 2.0);  // Δf = 2 Hz
  EXPECT_EQ(spectrum.frequency[20], 40.0);
  EXPECT_NEAR(spectrum.density[20] / line, 1.0, 1e-12);
  EXPECT_NEAR(spectrum.density[19] / line, 0.25, 1e-12);
  EXPECT_NEAR(spectrum.density[21] / line, 0.25, 1e-12);
  EXPECT_LT(spectrum.density[0], 1e-24);  // the mean is removed
  EXPECT_LT(spectrum.density[100], 1e-24);
  EXPECT_NEAR(power_of(spectrum), 4.5, 1e-11);
}

// A constant at half the sample rate is a line that has no mirror image: its power counts once.
TEST(Welch, CountsHalfTheSampleRateOnce) {
  std::vector<double> signal(4000);
  for (std::size_t n = 0; n < signal.size(); ++n) signal[n] = n % 2 == 0 ? 1.0 : -1.0;
  EXPECT_NEAR(power_of(welch(signal, 1000.0, 100)), 1.0, 1e-12);
}

// A signal shorter than the segment asked for is one segment; one too short to have a spectrum is a mistake.
TEST(Welch, TakesAShortSignalAsOneSegment) {
  EXPECT_EQ(welch(noise(101, 1.0, 1), 100.0, 4096).averages, 1U);
  EXPECT_EQ(welch(noise(101, 1.0, 1), 100.0, 4096).frequency.size(), 51U);
  EXPECT_THROW(static_cast<void>(welch(noise(3, 1.0, 1), 100.0, 2)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(welch(noise(30, 1.0, 1), 0.0, 2)), std::invalid_argument);
}

}  // namespace
