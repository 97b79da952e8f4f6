// Block length and overlap from record length and the sharpest peak wanted.
#include "host_sim/frf/block_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "host_sim/frf/estimators.hpp"
#include "tests/host_sim/frf/signals.hpp"

namespace block_choice_test {
namespace {

using host_sim::WindowShape;
using host_sim::frf::BlockChoice;
using host_sim::frf::BlockWish;
using host_sim::frf::choose_blocks;
using host_sim::frf::CrossSpectra;
using host_sim::frf::peak_bias;

constexpr double pi = std::numbers::pi;

std::optional<BlockChoice> choose(std::vector<std::size_t> recordings, const BlockWish& wish, double rate = 1000.0) {
  return choose_blocks(recordings, rate, wish);
}

// Point. Equation (1) in closed form: Hann (4/3)/(BT)² for long blocks (the next term is some (BT)⁻⁴), a rectangular
// window (1 − e^{−a})/a with a = πBT for all. A block of no length sees no peak.
TEST(PeakBias, IsItsEquation) {
  EXPECT_NEAR(peak_bias(WindowShape::hann, 20.0), 4.0 / 3.0 / 400.0, 1e-4);
  EXPECT_NEAR(peak_bias(WindowShape::hann, 10.0), 4.0 / 3.0 / 100.0, 5e-4);
  for (const double BT : {0.3, 1.0, 5.0, 30.0}) {
    const double a = pi * BT;
    EXPECT_NEAR(peak_bias(WindowShape::rectangular, BT), (1.0 - std::exp(-a)) / a, 1e-9) << BT;
  }
  EXPECT_EQ(peak_bias(WindowShape::hann, 0.0), 1.0);
}

// Law. That is what a mode's estimated peak loses: 2 % damping at 10 Hz, sampled at 100 Hz, blocks of 10.24 s, BT
// = 4.1: 6.6 %. 160 000 samples, no noise but what the blocks themselves leave: it scatters by some 0.5 %.
TEST(PeakBias, IsWhatAnEstimatedPeakLoses) {
  const double zeta = 0.02, rate = 100.0, omega = 2.0 * pi * 10.0;
  const double decay = zeta * omega, damped = omega * std::sqrt(1.0 - zeta * zeta);
  std::vector<double> taps(800);
  for (std::size_t n = 0; n < taps.size(); ++n) {
    const double t = static_cast<double>(n) / rate;
    taps[n] = std::exp(-decay * t) * std::sin(damped * t);
  }
  const std::uint64_t seed = 2;
  const auto x = support::white(160000, 1.0, seed);
  const auto y = support::filtered(x, taps);
  CrossSpectra spectra(rate, {1024, 512}, 2, 1);
  const host_sim::frf::ShiftedSignal signals[] = {{x}, {y}};
  spectra.add(signals);
  const std::size_t peak = static_cast<std::size_t>(std::lround(10.0 * 10.24));
  const double turns = spectra.frequency(peak) / rate;
  const double estimated = std::abs(spectra.cross(0, 1, peak)) / spectra.power(0, peak);
  const double lost = 1.0 - estimated / std::abs(support::response(taps, turns));
  const double expected = peak_bias(WindowShape::hann, 2.0 * zeta * 10.0 * 10.24);
  EXPECT_NEAR(expected, 0.066, 0.002);
  EXPECT_NEAR(lost, expected, 0.015) << "seed " << seed;
}

// Law. Of b² + ε² the choice is the least: shorter or longer blocks are no better. For Hann and half overlap the
// optimum is T⁵ = (64/9) κ L/(c B⁴), with κ = 1.9 averages a block length and c = (1 − γ²)/(2γ²) – here 20.3 s; lengths
// come in steps of 4 %, and where the error is flat, its third term counts: 15 %.
TEST(BlockChoice, BalancesBiasAgainstScatter) {
  BlockWish wish;  // B = 0.48 Hz
  const auto chosen = choose({600000}, wish);
  ASSERT_TRUE(chosen.has_value());
  const double c = 0.1 / 1.8, B = wish.bandwidth();
  const double optimum = std::pow(64.0 / 9.0 * 1.9 * 600.0 / (c * std::pow(B, 4)), 0.2);
  const double seconds = static_cast<double>(chosen->scheme.length) / 1000.0;
  EXPECT_NEAR(seconds / optimum, 1.0, 0.15);
  EXPECT_EQ(chosen->scheme.hop, chosen->scheme.length / 2);
  EXPECT_EQ(host_sim::good_fft_size(chosen->scheme.length), chosen->scheme.length);
  const auto error = [](const BlockChoice& choice) { return std::hypot(choice.peak_bias, choice.random_error); };
  for (const double factor : {0.5, 0.8, 1.25, 2.0}) {
    BlockWish other = wish;
    other.block = seconds * factor;
    EXPECT_GE(error(*choose({600000}, other)), error(*chosen)) << factor;
  }
}

// What is wanted and what there is decide: sharper peaks and longer recordings get longer blocks; few averages more
// overlap; a rectangular window none.
TEST(BlockChoice, FollowsDampingAndLength) {
  BlockWish wish, sharp;
  sharp.lowest_damping = 0.1;
  EXPECT_GT(choose({600000}, sharp)->scheme.length, choose({600000}, wish)->scheme.length);
  EXPECT_GT(choose({600000}, wish)->scheme.length, choose({60000}, wish)->scheme.length);
  const auto few = choose({30000}, wish);
  EXPECT_EQ(few->scheme.hop, few->scheme.length / 4);
  BlockWish box = wish;
  box.window = WindowShape::rectangular;
  EXPECT_EQ(choose({600000}, box)->scheme.hop, choose({600000}, box)->scheme.length);
  // Joined recordings count together, and the shortest limits the block.
  EXPECT_GT(choose({60000, 60000, 60000}, wish)->scheme.length, choose({60000}, wish)->scheme.length);
  EXPECT_LE(choose({600000, 5000}, wish)->scheme.length, 5000U);
}

// What the user gives is taken: a block to the next fast length, an overlap to the sample.
TEST(BlockChoice, TakesWhatIsGiven) {
  BlockWish wish;
  wish.block = 1.0;
  wish.overlap = 0.3;
  const auto chosen = choose({60000}, wish);
  EXPECT_EQ(chosen->scheme.length, 1000U);
  EXPECT_EQ(chosen->scheme.hop, 700U);
  wish.block = 0.997;
  EXPECT_EQ(choose({60000}, wish)->scheme.length, 1000U);
}

// Too short: not even 1/B in five blocks by half, or not two of the blocks given.
TEST(BlockChoice, SaysWhenThereIsTooLittle) {
  BlockWish wish;
  const double needed = host_sim::frf::needed_duration(wish, 1000.0);
  EXPECT_NEAR(needed, 3.0 / 0.48, 1e-9);
  EXPECT_TRUE(choose({static_cast<std::size_t>(1000.0 * needed) + 2}, wish).has_value());
  EXPECT_FALSE(choose({static_cast<std::size_t>(1000.0 * needed) - 2}, wish).has_value());
  EXPECT_FALSE(choose({10}, wish).has_value());
  EXPECT_FALSE(choose({}, wish).has_value());
  wish.block = 1.0;
  EXPECT_FALSE(choose({1400}, wish).has_value());
  EXPECT_TRUE(choose({2000}, wish).has_value());
  wish.block = 1e5;
  EXPECT_FALSE(choose({2000}, wish).has_value());
}

}  // namespace
}  // namespace block_choice_test
