#include "host_sim/signal/line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/host_sim/signal/normal_noise.hpp"

namespace {

constexpr double period = 1e-3, first_time = 0.37;

std::vector<double> sine(double frequency, double a, double b, std::size_t count) {
  std::vector<double> signal(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double phase = 2.0 * std::numbers::pi * frequency * (first_time + static_cast<double>(k) * period);
    signal[k] = a * std::cos(phase) + b * std::sin(phase);
  }
  return signal;
}

// The mirrored line at −50.07 Hz lies 400 bins away, where a Hann window leaks less than 1/400³.
TEST(Line, HasTheAmplitudesOfBothPhases) {
  const auto line = host_sim::line_in(sine(50.07, 0.3, -0.7, 4000), 50.07, period, first_time);
  EXPECT_NEAR(line.real(), 0.3, 1e-7);
  EXPECT_NEAR(line.imag(), 0.7, 1e-7);
}

TEST(Line, LeaksLittleBeyondTwoBins) {
  const std::vector<double> signal = sine(50.07, 1.0, 0.0, 4000);
  for (const double bins : {2.0, 2.5, 3.5, 7.3}) {
    EXPECT_LT(std::abs(host_sim::line_in(signal, 50.07 + bins / 4.0, period, first_time)), 0.03) << bins;
  }
}

// Deviation σ √(3/n): of 400 real and imaginary parts its own deviation is 1/√800 = 3.5 %; four of them.
TEST(Line, OfNoiseHasTheDeviationOfItsWindow) {
  double sum = 0.0;
  constexpr unsigned trials = 200;
  for (unsigned seed = 0; seed < trials; ++seed) {
    sum += std::norm(host_sim::line_in(sample::noise(1000, 2.0, seed), 123.4, period, first_time));
  }
  const double deviation = std::sqrt(sum / (2.0 * trials));
  EXPECT_NEAR(deviation, 2.0 * std::sqrt(3.0 / 1000.0), 4.0 * 0.035 * deviation);
}

TEST(Line, OfNothingIsNone) { EXPECT_EQ(std::abs(host_sim::line_in({}, 50.0, period, 0.0)), 0.0); }

}  // namespace
