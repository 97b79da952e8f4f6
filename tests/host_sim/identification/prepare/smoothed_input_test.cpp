// The input without the noise above its motion.
#include "host_sim/identification/prepare/smoothed_input.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/simulation/road.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "tests/support/reference_road.hpp"

namespace smoothed_input_test {
namespace {

namespace thresholds = host_sim::identification::thresholds;
using host_sim::identification::edge_of_motion;
using host_sim::identification::known_up_to;
using host_sim::identification::smoothed;
using host_sim::identification::smoothing_edge;

constexpr double period = 1e-3;

std::vector<double> wave(double amplitude, double frequency, std::size_t n) {
  std::vector<double> result(n);
  for (std::size_t k = 0; k < n; ++k) {
    result[k] = amplitude * std::sin(2.0 * std::numbers::pi * frequency * period * static_cast<double>(k) + 0.4);
  }
  return result;
}

std::vector<double> with_noise(std::vector<double> values, double level, std::uint64_t seed) {
  support::NormalNoise noise(seed);
  for (double& v : values) v += level * noise();
  return values;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t margin) {
  double largest = 0.0;
  for (std::size_t k = margin; k + margin < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

// Law (1). A window of 100 dB leaves 1e-5 on either side of the edge.
TEST(SmoothedInput, PassesBelowItsEdgeAndStopsAbove) {
  const double edge = 50.0;
  const auto reach = static_cast<std::size_t>(thresholds::smoothing_reach / period);
  const auto below = wave(1.0, edge - thresholds::smoothing_transition, 5'000);
  const auto above = wave(1.0, edge + thresholds::smoothing_transition, 5'000);
  EXPECT_LT(largest_difference(smoothed(below, edge, period), below, reach), 2e-5);
  EXPECT_LT(largest_difference(smoothed(above, edge, period), std::vector<double>(5'000), reach), 2e-5);
}

// Law (2). A cubic's part of second order goes on beyond the ends, so a parabola stays, but for 1e-7: the filter
// passes a curvature of 10 as it passes what is slow, to 1e-5. Of a sine of 5 Hz with
// an edge of 100 Hz the mirrored third derivative leaves (2π·5/(2π·100))³/6 · 5 of the amplitude at most, 1e-4.
TEST(SmoothedInput, KeepsValueSlopeAndCurvatureAtTheEnds) {
  std::vector<double> parabola(2'000);
  for (std::size_t k = 0; k < parabola.size(); ++k) {
    const double t = period * static_cast<double>(k);
    parabola[k] = 0.3 - 2.0 * t + 5.0 * t * t;
  }
  EXPECT_LT(largest_difference(smoothed(parabola, 100.0, period), parabola, 0), 1e-6);
  const auto slow = wave(1.0, 5.0, 2'345);
  EXPECT_LT(largest_difference(smoothed(slow, 100.0, period), slow, 0), 1e-4);
}

// Law. What is known of an acceleration ends where the position sinks into its noise: white noise of σ through ω² up to
// 28 … 44 Hz is σ (2π 36)² √(2·36/1000/5) = 0.12 m/s², where second differences of the samples leave 49.
TEST(SmoothedInput, KnowsItsAccelerationAsFarAsItIsAboveNoise) {
  const auto z = wave(2e-3, 12.0, 20'000), noisy = with_noise(z, 2e-5, 3);
  const double known = known_up_to(noisy, {2e-5}, period);
  EXPECT_NEAR(known, 12.0, 3.0) << "seed 3";  // bins of 1 Hz, a Hann window's main lobe of ± 2
  const auto edge = edge_of_motion(noisy, {2e-5}, period, 1);
  ASSERT_TRUE(edge.has_value());
  EXPECT_EQ(*edge, smoothing_edge(known));
  const auto motion = firmware::through_samples(smoothed(noisy, *edge, period), 1.0 / period);
  double error = 0.0;
  for (std::size_t k = 0; k < z.size(); ++k) {
    const double truth = -std::pow(2.0 * std::numbers::pi * 12.0, 2) * z[k];
    error += std::pow(motion[k].acceleration - truth, 2) / static_cast<double>(z.size());
  }
  EXPECT_LT(std::sqrt(error), 0.25);
}

// Law. Behind a filter of 20 Hz noise is lower above, and motion of 60 Hz that white noise of that level would cover is
// known.
TEST(SmoothedInput, ComparesWithTheNoiseAsItIsColoured) {
  auto z = wave(2e-3, 12.0, 20'000);
  const auto fast = wave(6e-7, 60.0, 20'000);
  for (std::size_t k = 0; k < z.size(); ++k) z[k] += fast[k];
  EXPECT_LT(known_up_to(z, {2e-5}, period), 20.0);
  EXPECT_NEAR(known_up_to(z, {2e-5, {20.0, 4}}, period), 60.0, 3.0);
}

// Point. A step is motion, however little its power is in a long recording; and where nothing is taken away, the input
// is as recorded.
TEST(SmoothedInput, LeavesStepsAndQuietSensorsAlone) {
  auto z = with_noise(wave(2e-3, 2.0, 60'000), 1e-5, 4);
  EXPECT_TRUE(edge_of_motion(z, {1e-5}, period, 1).has_value());
  EXPECT_FALSE(edge_of_motion(z, {0.0}, period, 1).has_value());
  const auto fast = with_noise(wave(1e-4, 40.0, 60'000), 1e-5, 5);
  EXPECT_TRUE(edge_of_motion(fast, {1e-5}, period, 1).has_value());
  EXPECT_FALSE(edge_of_motion(fast, {1e-5}, period, 10).has_value()) << "recorded at 100 Hz, it ends at 45";
  for (std::size_t k = 30'000; k < z.size(); ++k) z[k] += 2e-4;
  EXPECT_FALSE(edge_of_motion(z, {1e-5}, period, 1).has_value());
}

}  // namespace
}  // namespace smoothed_input_test
