// Third-octave bands: the standard's frequencies, and no power lost or counted twice.
#include "host_sim/signal/bands.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "tests/host_sim/signal/normal_noise.hpp"

namespace bands_test {
namespace {

using host_sim::Band;
using host_sim::band_rms;
using host_sim::BandRms;
using host_sim::nominal_name;
using host_sim::resolved_bands;
using host_sim::third_octave_band;
using sample::noise;

constexpr double pi = std::numbers::pi;

double variance_of(const std::vector<double>& signal) {
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
  double sum = 0.0;
  for (const double x : signal) sum += (x - mean) * (x - mean);
  return sum / static_cast<double>(signal.size());
}

double power_of(const BandRms& bands) {
  double power = bands.below * bands.below + bands.above * bands.above;
  for (const double rms : bands.rms) power += rms * rms;
  return power;
}

std::size_t band_of(const std::vector<Band>& bands, double frequency) {
  std::size_t i = 0;
  while (i + 1 < bands.size() && frequency >= bands[i].upper) ++i;
  return i;
}

// Point. The standard's exact mid-band frequencies and edges (annex A: 12.589 Hz from 11.220 to 14.125 Hz), and ten
// bands make a decade.
TEST(ThirdOctaveBand, HasTheFrequenciesOfTheStandard) {
  EXPECT_EQ(third_octave_band(0).centre, 1000.0);
  const Band band = third_octave_band(-19);
  EXPECT_NEAR(band.centre, 12.589254, 1e-6);
  EXPECT_NEAR(band.lower, 11.220185, 1e-6);
  EXPECT_NEAR(band.upper, 14.125375, 1e-6);
  for (int n = -40; n < 20; ++n) {
    EXPECT_EQ(third_octave_band(n).upper, third_octave_band(n + 1).lower) << n;
    EXPECT_NEAR(third_octave_band(n + 10).centre / third_octave_band(n).centre, 10.0, 1e-14) << n;
    EXPECT_NEAR(third_octave_band(n).lower * third_octave_band(n).upper / std::pow(third_octave_band(n).centre, 2), 1.0,
                1e-14);
  }
}

// Point. The names of the standard's annex E.
TEST(ThirdOctaveBand, HasTheNamesOfTheStandard) {
  const std::vector<const char*> names{
      "0.1", "0.125", "0.16", "0.2", "0.25", "0.315", "0.4", "0.5",  "0.63", "0.8", "1",   "1.25", "1.6",  "2",
      "2.5", "3.15",  "4",    "5",   "6.3",  "8",     "10",  "12.5", "16",   "20",  "25",  "31.5", "40",   "50",
      "63",  "80",    "100",  "125", "160",  "200",   "250", "315",  "400",  "500", "630", "800",  "1000", "1250"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(nominal_name(third_octave_band(static_cast<int>(i) - 40)), names[i]);
  }
  EXPECT_EQ(nominal_name(third_octave_band(10)), "10000");
  EXPECT_EQ(nominal_name(third_octave_band(-41)), "0.08");
}

// A minute at 1 kHz: lines of 1/60 Hz, so four of them are 0.067 Hz, the width of the band at 0.315 Hz (0.073 Hz; that
// at 0.25 Hz has 0.058 Hz). The last band that begins below 500 Hz is that around 500 Hz (446.7 … 562.3 Hz).
TEST(ResolvedBands, AreThoseThatTheSamplesCanTell) {
  const std::vector<Band> bands = resolved_bands(60000, 1000.0);
  EXPECT_EQ(nominal_name(bands.front()), "0.315");
  EXPECT_EQ(nominal_name(bands.back()), "500");
  for (std::size_t i = 1; i < bands.size(); ++i) EXPECT_EQ(bands[i].number, bands[i - 1].number + 1);
  EXPECT_TRUE(resolved_bands(15, 1000.0).empty());
  EXPECT_EQ(resolved_bands(60000, 2.0).front().number, resolved_bands(60000, 2000.0).front().number - 30);
}

// Law. The bands, and what is outside them, together have the signal's variance: for lengths with and without large
// prime factors, for slow and fast signals, for a road-like walk whose ends do not meet. Rounding only.
TEST(BandRms, AddsUpToTheVariance) {
  for (const std::size_t count : {2U, 3U, 16U, 17U, 1000U, 14951U, 20011U}) {
    std::vector<double> walk = noise(count, 1.0, 3);
    std::partial_sum(walk.begin(), walk.end(), walk.begin());
    std::vector<double> sine(count);
    for (std::size_t n = 0; n < count; ++n) sine[n] = 5.0 + std::sin(0.01 * static_cast<double>(n * n % 997));
    std::vector<double> step(count, 0.0);
    step.back() = 1.0;  // nothing but an end, which the taper would take away
    for (const std::vector<double>& signal : {noise(count, 1.0, 4), walk, sine, step}) {
      for (const std::vector<Band>& bands : {resolved_bands(count, 500.0),
                                             {third_octave_band(-19)},
                                             {third_octave_band(20)},
                                             {third_octave_band(-90)},
                                             {}}) {
        EXPECT_NEAR(power_of(band_rms(signal, 500.0, bands)) / variance_of(signal), 1.0, 1e-12) << count;
      }
    }
  }
}

// White noise of variance σ² has σ² (f₂ − f₁)/(f_s/2) between f₁ and f₂, with a relative standard error of its power of
// 1/√m for m lines in the band (each has two degrees of freedom; the taper and the padding cost less than 10 % of
// them). Five of those; the narrow bands, with less than 50 lines, are left out.
TEST(BandRms, SharesOutWhiteNoiseByWidth) {
  const unsigned seed = 9;
  const double rate = 1000.0;
  const std::vector<double> signal = noise(59000, 2.0, seed);
  const std::vector<Band> bands = resolved_bands(signal.size(), rate);
  const BandRms result = band_rms(signal, rate, bands);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const double width = std::min(bands[i].upper, rate / 2.0) - bands[i].lower;
    const double lines = width * static_cast<double>(signal.size()) / rate;
    if (lines < 50.0) continue;
    const double expected = 4.0 * width / (rate / 2.0);
    EXPECT_NEAR(result.rms[i] * result.rms[i] / expected, 1.0, 5.5 / std::sqrt(lines))
        << nominal_name(bands[i]) << " Hz, seed " << seed;
  }
}

// A sine stands in its band with a/√2. A minute has lines of 1/60 Hz, its tapered ends of 3 s act from 1/3 Hz on:
// nearer than that power leaks as without a taper, 1/(π² m) of it beyond m lines (0.8 Hz: 5.5 lines to the edge, 1.8 %
// of the power, 0.9 % of the rms); farther away less than 10⁻⁴.
TEST(BandRms, PutsASineIntoItsBand) {
  const double rate = 1000.0;
  for (const double frequency : {0.8, 4.1, 12.9, 100.3, 430.0}) {
    std::vector<double> signal(60000);
    for (std::size_t n = 0; n < signal.size(); ++n) {
      signal[n] = 40.0 + 3.0 * std::cos(2.0 * pi * frequency * static_cast<double>(n) / rate + 0.5);
    }
    const std::vector<Band> bands = resolved_bands(signal.size(), rate);
    const BandRms result = band_rms(signal, rate, bands);
    EXPECT_NEAR(result.rms[band_of(bands, frequency)] / (3.0 / std::sqrt(2.0)), 1.0, frequency < 1.0 ? 9e-3 : 1e-4)
        << frequency;
  }
}

// A line of the spectrum that an edge cuts in its middle is shared by the two bands; the one at half the sample rate
// counts like any other. Tones of power 1 at 100 Hz, the edge, and at 500 Hz, in lines of 1 Hz.
TEST(BandRms, SharesALineAtAnEdge) {
  std::vector<double> signal(1000);
  for (std::size_t n = 0; n < signal.size(); ++n) {
    signal[n] = std::sqrt(2.0) * std::sin(0.2 * pi * static_cast<double>(n) + 0.3) + (n % 2 == 0 ? 1.0 : -1.0);
  }
  const std::vector<Band> bands{{0, 50.0, 70.0, 100.0}, {1, 100.0, 120.0, 400.0}};
  const BandRms result = band_rms(signal, 1000.0, bands);
  EXPECT_NEAR(result.rms[0] * result.rms[0], 0.5, 2e-3);  // but for what the tapered ends let through
  EXPECT_NEAR(result.rms[1] * result.rms[1], 0.5, 2e-3);
  EXPECT_NEAR(result.above * result.above, 1.0, 2e-3);
}

// A signal that is one impulse at its end is white; tapered nothing would be left of it but its mean.
TEST(BandRms, SeesAnImpulseAtTheEnd) {
  std::vector<double> signal(1000, 0.0);
  signal.back() = 1.0;
  const std::vector<Band> bands{{0, 100.0, 150.0, 200.0}};
  const BandRms result = band_rms(signal, 1000.0, bands);
  EXPECT_NEAR(result.rms[0] * result.rms[0] / variance_of(signal), 0.2, 2e-3);
}

// The reason for the taper. A slow ramp of 1, as the road's or a sensor's drift over a minute, would appear as its jump
// at the ends in every band: its lines have the amplitude 1/(π f T), so the 174 lines of the band at 12.5 Hz the rms
// √(174/2)/(π · 12.6 · 60) = 4e-3, as much as a real signal there. Tapered over 3 s it is three orders smaller.
TEST(BandRms, KeepsADriftOutOfTheFastBands) {
  std::vector<double> ramp(60000);
  for (std::size_t n = 0; n < ramp.size(); ++n) ramp[n] = static_cast<double>(n) / 60000.0;
  const std::vector<Band> bands = resolved_bands(ramp.size(), 1000.0);
  const BandRms result = band_rms(ramp, 1000.0, bands);
  EXPECT_LT(result.rms[band_of(bands, 12.5)], 4e-6);
  EXPECT_NEAR(result.below, std::sqrt(1.0 / 12.0), 1e-3);
}

// A constant has no rms, an empty signal neither.
TEST(BandRms, OfAConstantIsNothing) {
  const std::vector<Band> bands = resolved_bands(1000, 100.0);
  for (const std::vector<double>& signal : {std::vector<double>(1000, 0.1), std::vector<double>(), {1.0}}) {
    const BandRms result = band_rms(signal, 100.0, bands);
    EXPECT_EQ(result.rms.size(), bands.size());
    EXPECT_LT(power_of(result), 1e-28);
  }
}

}  // namespace
}  // namespace bands_test
