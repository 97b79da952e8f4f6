#include "firmware/loop/estimator/velocity_observer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

namespace {

using firmware::Observers;
using firmware::VelocityObserver;
using Inputs = VelocityObserver::Inputs;

constexpr double h = 1e-3;
constexpr double two_pi = 6.283185307179586;

/// Largest error against `expected` velocity amplitude (complex, of a displacement 1·sin) over whole periods of a sine,
/// after everything that is not the sine has died away.
double error_at(double frequency, Inputs inputs, std::complex<double> transfer, double bias = 0.0) {
  VelocityObserver observer(inputs, Observers{}, h);
  const double w = two_pi * frequency;
  double worst = 0.0;
  const int settled = 8000;  // 8 s: slowest pole decays with 3 1/s, e^{−25}
  for (int k = 0; k < settled + 4000; ++k) {
    const double t = h * k;
    const double v = observer.step(std::sin(w * t), -w * w * std::sin(w * t) + bias);
    const std::complex<double> expected = transfer * std::polar(1.0, w * t);
    if (k >= settled) worst = std::max(worst, std::abs(v - expected.imag()));
  }
  return worst;
}

// Law (2). Joined, the two are the velocity at every frequency: below, at and above the cross-over. The bound is the
// sine's peaks cut by straight lines, (2πf h)²/12, and the rounding of differences at low frequency.
TEST(VelocityObserver, IsExactWhereBothAreMeasured) {
  for (const double f : {0.1, 0.5, 1.0, 2.0, 8.0, 13.0, 30.0}) {
    const double w = two_pi * f;
    EXPECT_LT(error_at(f, Inputs::both, {0.0, w}), w * ((w * h) * (w * h) / 12.0 * 1.1 + 1e-9)) << f;
  }
}

// Law (2). The factor s² + 2ω s of A vanishes at s = 0: a bias leaves no trace once its transient is gone.
TEST(VelocityObserver, ForgetsABiasOfTheAccelerometer) {
  const double w = two_pi * 2.0;
  EXPECT_LT(error_at(2.0, Inputs::both, {0.0, w}, 3.0), w * ((w * h) * (w * h) / 12.0 * 1.1 + 1e-9) + 3.0 * 1e-9);
}

// Point (3): displacement alone is s ω²/(s² + √2 ω s + ω²), amplitude and phase.
TEST(VelocityObserver, DifferentiatesWithoutAccelerometer) {
  for (const double f : {0.5, 2.0, 13.0, 30.0}) {
    const std::complex<double> s(0.0, two_pi * f);
    const double w = two_pi * 30.0;
    const std::complex<double> transfer = s * w * w / (s * s + std::sqrt(2.0) * w * s + w * w);
    const double size = std::abs(s);
    EXPECT_LT(error_at(f, Inputs::displacement, transfer), size * ((size * h) * (size * h) / 12.0 * 1.1 + 1e-9)) << f;
  }
}

// Point (4): acceleration alone is s A/(s² + √2 ω s + ω²) with A = s² Z.
TEST(VelocityObserver, IntegratesWithoutDisplacement) {
  for (const double f : {0.5, 2.0, 13.0}) {
    const std::complex<double> s(0.0, two_pi * f);
    const double w = two_pi * 1.0;
    const std::complex<double> transfer = s * s * s / (s * s + std::sqrt(2.0) * w * s + w * w);
    const double size = std::abs(s);
    EXPECT_LT(error_at(f, Inputs::acceleration, transfer), size * ((size * h) * (size * h) / 12.0 * 1.1 + 1e-9)) << f;
  }
}

/// rms velocity from white noise on both inputs.
double noise(Inputs inputs, const Observers& settings, double sigma_y, double sigma_a, unsigned seed) {
  VelocityObserver observer(inputs, settings, h);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  const int settled = 5000, samples = 300'000;
  for (int k = 0; k < settled + samples; ++k) {
    const double y = sigma_y * normal(random);
    const double v = observer.step(y, sigma_a * normal(random));
    if (k >= settled) sum += v * v;
  }
  return std::sqrt(sum / samples);
}

// Point (5), each term alone and both. The estimate is correlated over about 1/ω = 0.16 s, so 300 s hold some 900
// independent values: standard deviation of the rms 1/√(2·900) = 2.4 %, four of them.
TEST(VelocityObserver, PassesNoiseAsPredicted) {
  constexpr unsigned seed = 3;
  const double w = two_pi;
  const double sigma_y = 0.25e-3, sigma_a = 0.018;
  const double from_y = std::sqrt(h * 1.5 * w * w * w) * sigma_y;
  const double from_a = std::sqrt(h / w) * sigma_a;
  EXPECT_NEAR(noise(Inputs::both, {}, sigma_y, 0.0, seed) / from_y, 1.0, 0.1) << "seed " << seed;
  EXPECT_NEAR(noise(Inputs::both, {}, 0.0, sigma_a, seed) / from_a, 1.0, 0.1) << "seed " << seed;
  EXPECT_NEAR(std::hypot(from_y, from_a), 0.27e-3, 0.005e-3) << "the figure stated with the default";

  // (3) at 30 Hz: shorter memory, and straight lines between samples take (ωh)²/12 and less away.
  const double w3 = two_pi * 30.0;
  const double differentiated = std::sqrt(h * w3 * w3 * w3 / (2.0 * std::sqrt(2.0))) * sigma_y;
  EXPECT_NEAR(noise(Inputs::displacement, {}, sigma_y, 0.0, seed) / differentiated, 1.0, 0.1) << "seed " << seed;
  EXPECT_NEAR(differentiated, 12e-3, 1e-3) << "the figure stated with the default";
}

// The default cross-over is where Table 2's noise ends up smallest: a factor of 3 away it is clearly larger.
TEST(VelocityObserver, HasItsCrossOverWhereNoiseIsSmallest) {
  const auto predicted = [](double frequency) {
    const double w = two_pi * frequency;
    return std::sqrt(h * (1.5 * w * w * w * 0.25e-3 * 0.25e-3 + 0.018 * 0.018 / w));
  };
  const double best = std::sqrt(std::sqrt(2.0) / 3.0 * 0.018 / 0.25e-3) / two_pi;
  EXPECT_NEAR(best, Observers{}.cross_over, 0.08);
  EXPECT_LT(predicted(1.0), 1.01 * predicted(best));
  EXPECT_GT(predicted(3.0), 1.4 * predicted(best));
  EXPECT_GT(predicted(1.0 / 3.0), 1.4 * predicted(best));
}

// A rig stands still when the program starts, wherever it stands: no transient from the origin.
TEST(VelocityObserver, StartsAtRestWhereverItIs) {
  for (const Inputs inputs : {Inputs::both, Inputs::displacement}) {
    VelocityObserver observer(inputs, Observers{}, h);
    for (int k = 0; k < 1000; ++k) EXPECT_NEAR(observer.step(0.1, 0.0), 0.0, 1e-12);
  }
}

// A slow rig must not be asked for frequencies it cannot see: the estimate stays bounded at any sampling rate.
TEST(VelocityObserver, TakesFrequenciesDownToWhatTheRateAllows) {
  VelocityObserver observer(Inputs::displacement, Observers{.differentiation = 30.0}, 0.1);
  VelocityObserver quarter(Inputs::displacement, Observers{.differentiation = 2.5}, 0.1);
  for (int k = 0; k < 50; ++k) {
    const double y = 0.01 * std::sin(0.3 * k);
    EXPECT_EQ(observer.step(y, 0.0), quarter.step(y, 0.0));
  }
}

TEST(VelocityObserver, IgnoresWhatItDoesNotUse) {
  VelocityObserver one(Inputs::displacement, Observers{}, h), other(Inputs::displacement, Observers{}, h);
  VelocityObserver three(Inputs::acceleration, Observers{}, h), four(Inputs::acceleration, Observers{}, h);
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(one.step(0.01 * k, 0.0), other.step(0.01 * k, 1e300));
    EXPECT_EQ(three.step(0.0, 0.01 * k), four.step(1e300, 0.01 * k));
  }
}

}  // namespace
