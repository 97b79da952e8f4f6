// Estimators of a frequency response, and whether their bounds hold what they promise.
#include "host_sim/frf/estimators.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "host_sim/frf/cross_spectra.hpp"
#include "tests/host_sim/frf/signals.hpp"

namespace estimators_test {
namespace {

using host_sim::frf::BlockScheme;
using host_sim::frf::Bounds;
using host_sim::frf::Complex;
using host_sim::frf::CrossSpectra;
using host_sim::frf::Estimator;
using host_sim::frf::LineSpectra;
using host_sim::frf::Quantiles;
using host_sim::frf::student_quantile;
using support::filtered;
using support::sum;
using support::white;

constexpr double pi = std::numbers::pi;

// Point. Tables (ν = 1: tan 0.475π), not whole and large ν: 1.959964 of the normal distribution + its first correction
// (z³ + z)/(4ν).
TEST(StudentQuantile, AgreesWithTables) {
  EXPECT_NEAR(student_quantile(1.0), std::tan(0.475 * pi), 1e-7);
  EXPECT_NEAR(student_quantile(2.0), 0.95 * std::sqrt(2.0 / (1.0 - 0.95 * 0.95)), 1e-8);
  EXPECT_NEAR(student_quantile(5.5), 2.501858612469493, 1e-7);
  EXPECT_NEAR(student_quantile(10.0), 2.2281388519649385, 1e-8);
  const double z = 1.9599639845400545;
  EXPECT_NEAR(student_quantile(1e5), z + (z * z * z + z) / 4e5, 1e-8);
  EXPECT_THROW(static_cast<void>(student_quantile(0.5)), std::invalid_argument);
}

// Point. Equations (1)–(4) by hand: S_xx = 2, S_yy = 9, S_xy = 2 + 2j, S_zx = 1 − j, S_zy = 4; γ² = 8/18.
TEST(Estimators, AreTheirEquations) {
  const LineSpectra s{5.0, 2.0, 9.0, {1.0, -1.0}, {4.0, 0.0}, {2.0, 2.0}};
  const auto near = [&](Estimator estimator, Complex expected) {
    EXPECT_LT(std::abs(estimate(s, estimator) - expected), 1e-14) << name(estimator);
  };
  near(Estimator::h1, {1.0, 1.0});
  near(Estimator::h2, Complex(1.0, 1.0) * 9.0 / 4.0);
  near(Estimator::hv, Complex(1.0, 1.0) * 1.5);
  near(Estimator::instrument, {2.0, 2.0});
  EXPECT_DOUBLE_EQ(host_sim::frf::coherence(s.xx, s.yy, s.xy), 8.0 / 18.0);
  EXPECT_EQ(host_sim::frf::coherence(0.0, 9.0, 0.0), 0.0);
  EXPECT_EQ(host_sim::frf::coherence(1.0, 1.0, 1.0 + 1e-15), 1.0);
}

// Law. Hv is the geometric mean of the others and does not depend on units; H1 and H2 bound it.
TEST(Estimators, HvLiesBetweenTheOthersInAllUnits) {
  const LineSpectra s{1.0, 2.0, 9.0, 1.0, 1.0, {2.0, 2.0}};
  const LineSpectra in_millimetres{1.0, 2e6, 9.0, 1e3, 1.0, {2e3, 2e3}};
  const Complex h1 = estimate(s, Estimator::h1), h2 = estimate(s, Estimator::h2), hv = estimate(s, Estimator::hv);
  EXPECT_LT(std::abs(hv * hv - h1 * h2), 1e-13);
  EXPECT_LT(std::abs(1e3 * estimate(in_millimetres, Estimator::hv) - hv), 1e-12);
}

// Point. Bendat and Piersol's bound for H1: R² = t²/ν · (1 − γ²) S_yy/S_xx with ν = 2 (K − 1). K = 11, γ² = 0.5, |H1| =
// 1: S_yy/S_xx = 2, R = 2.0860/√20.
TEST(Bounds, OfH1AreBendatAndPiersols) {
  const LineSpectra s{1.0, 1.0, 2.0, 1.0, {0.0, 1.0}, {0.0, 1.0}};
  const Bounds b = bounds(s, Estimator::h1, Quantiles(11.0));
  const double radius = 2.0859634473 / std::sqrt(20.0);
  EXPECT_TRUE(b.determined);
  EXPECT_NEAR(b.lowest_magnitude, 1.0 - radius, 1e-8);
  EXPECT_NEAR(b.highest_magnitude, 1.0 + radius, 1e-8);
  EXPECT_NEAR(b.lowest_phase, 0.5 * pi - std::asin(radius), 1e-8);
  EXPECT_NEAR(b.highest_phase, 0.5 * pi + std::asin(radius), 1e-8);
}

// Point. Equation (8) for K = 11, γ² = 0.5, |Hv| = √2: a factor exp(asinh(2.0860 √(0.5/20))) to both sides.
TEST(Bounds, OfHvArePitmans) {
  const LineSpectra s{1.0, 1.0, 2.0, 1.0, {0.0, 1.0}, {0.0, 1.0}};
  const Bounds b = bounds(s, Estimator::hv, Quantiles(11.0));
  const double factor = std::exp(std::asinh(2.0859634473 * std::sqrt(0.5 / 20.0)));
  EXPECT_TRUE(b.determined);
  EXPECT_NEAR(b.lowest_magnitude, std::sqrt(2.0) / factor, 1e-8);
  EXPECT_NEAR(b.highest_magnitude, std::sqrt(2.0) * factor, 1e-8);
  const Bounds h1 = bounds(s, Estimator::h1, Quantiles(11.0));
  EXPECT_NEAR(b.lowest_phase, h1.lowest_phase, 1e-12);
  EXPECT_NEAR(b.highest_phase, h1.highest_phase, 1e-12);
}

// Law. H2 of (x, y) is one over H1 of (y, x), and so are its bounds: the disc is turned inside out.
TEST(Bounds, OfH2AreThoseOfTheInverse) {
  const LineSpectra s{1.0, 2.0, 9.0, 1.0, 1.0, {2.5, 3.0}};
  const LineSpectra swapped{1.0, 9.0, 2.0, 1.0, 1.0, {2.5, -3.0}};
  const Bounds h2 = bounds(s, Estimator::h2, Quantiles(20.0));
  const Bounds inverse = bounds(swapped, Estimator::h1, Quantiles(20.0));
  EXPECT_NEAR(h2.lowest_magnitude * inverse.highest_magnitude, 1.0, 1e-12);
  EXPECT_NEAR(h2.highest_magnitude * inverse.lowest_magnitude, 1.0, 1e-12);
  EXPECT_NEAR(h2.lowest_phase, -inverse.highest_phase, 1e-12);
}

// Where coherence is below what unrelated signals reach, 1 − 0.05^{1/(K−1)}, nothing is claimed: any phase, no lower
// bound, and – of H2 and a weak instrument – no upper one. One average knows nothing at all; bounds never get lost in
// zeros.
TEST(Bounds, ClaimNothingWhereNothingIsKnown) {
  const double gamma2 = 1.0 - std::pow(0.05, 1.0 / 9.0);
  for (const double below : {0.98, 1.02}) {
    const LineSpectra s{1.0, 1.0, 1.0, 1.0, 1.0, std::polar(std::sqrt(below * gamma2), 2.0)};
    for (const Estimator estimator : {Estimator::h1, Estimator::h2, Estimator::hv}) {
      const Bounds b = bounds(s, estimator, Quantiles(10.0));
      EXPECT_EQ(b.determined, below > 1.0) << name(estimator) << ' ' << below;
      if (b.determined) continue;
      EXPECT_EQ(b.lowest_magnitude, 0.0);
      EXPECT_GE(b.highest_magnitude, std::abs(estimate(s, estimator)));
      EXPECT_DOUBLE_EQ(b.highest_phase - b.lowest_phase, 2.0 * pi);
    }
  }
  const LineSpectra weak{1.0, 1.0, 1.0, 0.1, 0.1, 0.9};
  EXPECT_EQ(bounds(weak, Estimator::instrument, Quantiles(10.0)).highest_magnitude,
            std::numeric_limits<double>::infinity());
  const LineSpectra sure{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  EXPECT_FALSE(bounds(sure, Estimator::h1, Quantiles(1.0)).determined);
  EXPECT_FALSE(bounds(LineSpectra{}, Estimator::h1, Quantiles(10.0)).determined);
  EXPECT_FALSE(bounds(LineSpectra{}, Estimator::hv, Quantiles(10.0)).determined);
}

/// How often bounds held the truth.
struct Coverage {
  int points = 0, magnitude = 0, phase = 0, determined = 0;

  void count(const Bounds& b, Complex truth) {
    ++points;
    if (b.determined) ++determined;
    if (std::abs(truth) >= b.lowest_magnitude && std::abs(truth) <= b.highest_magnitude) ++magnitude;
    const double middle = 0.5 * (b.lowest_phase + b.highest_phase);
    const double off = std::remainder(std::arg(truth) - middle, 2.0 * pi);
    if (std::abs(off) <= 0.5 * (b.highest_phase - b.lowest_phase) + 1e-12) ++phase;
  }
  [[nodiscard]] double share(int count) const { return static_cast<double>(count) / points; }
};

const std::vector<double> taps{1.0, 0.5, -0.3, 0.2};

struct Case {
  double noise_in, noise_out;  ///< rms, relative to the input's
  std::size_t blocks, hop;
  bool like_signal = false;  ///< the output's noise has the output's spectrum: equal parts of both powers
};

/// Bounds over 58 lines of `recordings` recordings of y = taps * x with noise. The estimate's own bias – 4 taps in a
/// block of 256: 1 − r(3/256) < 0.1 % of the last tap – is far inside the smallest random error here, 1 %.
Coverage coverage(const Case& c, Estimator estimator, int recordings, std::uint64_t seed) {
  constexpr std::size_t length = 256;
  Coverage result;
  std::optional<Quantiles> quantiles;
  for (int r = 0; r < recordings; ++r) {
    const std::size_t samples = length + (c.blocks - 1) * c.hop + taps.size();
    const std::uint64_t run = seed + static_cast<std::uint64_t>(r);
    std::vector<double> x = white(samples, 1.0, run, 1);
    const std::vector<double> noise = white(samples, c.noise_out, run, 2);
    std::vector<double> y = sum(filtered(x, taps), c.like_signal ? filtered(noise, taps) : noise);
    x = sum(x, white(samples, c.noise_in, run, 3));
    x.erase(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(taps.size()));  // where the filter starts
    y.erase(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(taps.size()));
    CrossSpectra spectra(1.0, {length, c.hop}, 2, 1);
    const host_sim::frf::ShiftedSignal signals[] = {{x}, {y}};
    spectra.add(signals);
    if (!quantiles) quantiles.emplace(spectra.effective_averages());
    for (std::size_t k = 4; k + 8 < spectra.lines(); k += 2) {  // neighbours share most of a Hann line
      const LineSpectra s{0.0, spectra.power(0, k), spectra.power(1, k), 0.0, 0.0, spectra.cross(0, 1, k)};
      result.count(bounds(s, estimator, *quantiles), support::response(taps, spectra.frequency(k)));
    }
  }
  return result;
}

/// `above`: where less than a fifth is determined, bounds that say "any phase" hold some more.
void expect_95(const Coverage& c, const std::string& what) {
  const double above = c.share(c.determined) < 0.2 ? 0.975 : 0.97;
  EXPECT_GT(c.share(c.magnitude), 0.93) << what;
  EXPECT_LT(c.share(c.magnitude), 0.97) << what;
  EXPECT_GT(c.share(c.phase), 0.93) << what;
  EXPECT_LT(c.share(c.phase), above) << what;
}

// The promise: 95 % bounds hold the truth at 93–97 % of the points, for noise from 3 % to 30 times the signal, few
// averages and many, blocks that do not overlap, by half and by three quarters. 7080 points: the share scatters by 0.3
// %. By integration over the noise, for many averages, the magnitude's bounds hold at 93.3–96.4 %, the phase's at
// 95–97.2 %.
TEST(Bounds, HoldTheTruthAtNinetyFiveOfAHundredPoints) {
  const std::uint64_t seed = 100;
  const std::vector<std::pair<std::size_t, std::size_t>> blocks{{8, 256}, {12, 128}, {40, 128}, {24, 64}, {10, 64}};
  for (const double noise : {0.03, 0.3, 1.0, 3.0, 30.0}) {
    for (const auto& [count, hop] : blocks) {
      const Coverage held = coverage({0.0, noise, count, hop}, Estimator::h1, 120, seed);
      ASSERT_EQ(held.points, 7080);
      expect_95(held, "noise " + std::to_string(noise) + ", " + std::to_string(count) + " blocks every " +
                          std::to_string(hop) + ", seed " + std::to_string(seed));
    }
  }
}

// The same for noise in the input (H2) and for equal noise in both (Hv); H1 then misses far more often.
TEST(Bounds, HoldForTheNoiseThatEachEstimatorIsMadeFor) {
  const std::uint64_t seed = 300;
  for (const double noise : {0.1, 0.5, 2.0}) {
    const Case input{noise, 0.0, 20, 128};
    expect_95(coverage(input, Estimator::h2, 120, seed), "H2, noise " + std::to_string(noise));
    const Case both{noise, noise, 20, 128, true};
    expect_95(coverage(both, Estimator::hv, 120, seed), "Hv, noise " + std::to_string(noise));
  }
  const Coverage wrong = coverage({0.5, 0.0, 20, 128}, Estimator::h1, 60, seed);
  EXPECT_LT(wrong.share(wrong.magnitude), 0.6) << "H1 with a noisy input comes out 20 % too low";
}

}  // namespace
}  // namespace estimators_test
